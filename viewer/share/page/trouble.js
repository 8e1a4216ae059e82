// Shows a sentence when something stops the page. This script runs first, in any browser. It is
// written in the JavaScript of 1999, so that it also works in browsers that cannot parse the other
// scripts.
var palpate = {};

palpate.tooOld =
    'This browser is too old for this page: open it in Chrome or Edge 91, Firefox 113 or Safari 16.4, ' +
    'or in a newer version.';
palpate.getAgain = 'get the file again, or make a new one with palpate share';

// Stops the page and shows only this sentence, which states the reason and a remedy. Later calls are
// ignored.
palpate.stop = function(sentence) {
  if (palpate.trouble) return;
  palpate.trouble = sentence.charAt(0).toUpperCase() + sentence.substring(1) +
      (/[.!?]$/.test(sentence) ? '' : '.');
  palpate.showTrouble();
};
palpate.goOn = function() {
  palpate.trouble = '';
  palpate.showTrouble();
};
palpate.showTrouble = function() {
  var shown = document.getElementById('trouble');
  if (!shown) return;  // the document is not loaded yet; the sentence is shown once it is
  shown.innerHTML = '';
  shown.appendChild(document.createTextNode(palpate.trouble));
  document.body.className = palpate.trouble ? 'stopped' : '';
  document.body.setAttribute('data-state', palpate.trouble ? 'stopped' : 'ready');
};

window.onerror = function(message, source) {
  var isOurs = String(source).split('#')[0] === location.href.split('#')[0];
  if (palpate.begun && !isOurs) return;  // ignores errors of browser extensions
  if (palpate.begun)
    palpate.stop(
        'this page stopped (' + message + '): reload it, or open it in another browser');
  else if (/syntax|expected|token/i.test(message))
    palpate.stop(palpate.tooOld);
  else
    palpate.stop(
        'this page could not start (' + message + '): open it in a newer browser, or ' +
        palpate.getAgain);
};
window.onload = function() {
  if (palpate.trouble) return palpate.showTrouble();
  if (palpate.begun) return;
  if (document.getElementById('end'))
    palpate.stop(palpate.tooOld);
  else
    palpate.stop('the file of this page was cut off: ' + palpate.getAgain);
};
