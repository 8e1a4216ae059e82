// What stops a page is said in a sentence. This runs before all else and in any browser, so it is
// the JavaScript of 1999: a browser that cannot read what follows must still be told so.
var palpate = {};

palpate.tooOld =
    'This browser is too old for this page: open it in Chrome or Edge 91, Firefox 113 or Safari 16.4, ' +
    'or in something newer.';
palpate.getAgain = 'get the file again, or make it again with palpate share';

// What stopped the page, and what to do; nothing else is seen then. The first trouble is the one
// that counts.
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
  if (!shown) return;  // not there yet: once more when all is
  shown.innerHTML = '';
  shown.appendChild(document.createTextNode(palpate.trouble));
  document.body.className = palpate.trouble ? 'stopped' : '';
  document.body.setAttribute('data-state', palpate.trouble ? 'stopped' : 'ready');
};

window.onerror = function(message, source) {
  var isOurs = String(source).split('#')[0] === location.href.split('#')[0];
  if (palpate.begun && !isOurs) return;  // what an extension of the browser does is no trouble here
  if (palpate.begun)
    palpate.stop(
        'this page stopped (' + message + '): load it again, or open it in another browser');
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
    palpate.stop('this page was cut off on its way: ' + palpate.getAgain);
};
