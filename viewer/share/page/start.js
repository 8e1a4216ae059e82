// Starts the page, and handles events that stop it.

// Returns whether the browser draws without a graphics card. There is then no time for smooth edges
// and many triangles.
function drawsBySoftware() {
  const gl = document.createElement('canvas').getContext('webgl');
  const named = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = named ? gl.getParameter(named.UNMASKED_RENDERER_WEBGL) : '';
  if (gl && gl.getExtension('WEBGL_lose_context'))
    gl.getExtension('WEBGL_lose_context').loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

// Starts the field in a thread of its own.
function startField(gl) {
  const code = new Blob([byId('worker').textContent], {type: 'text/javascript'});
  const worker = new Worker(URL.createObjectURL(code));
  worker.onerror = () => palpate.stop(
      'the browser cannot start the computation of forces: open the file in another browser');
  worker.onmessage = ({data}) => {
    if (data.tooOld)
      palpate.stop(palpate.tooOld);
    else if (data.trouble)
      palpate.stop(data.trouble);
    else if (data.damaged)
      palpate.stop(`this page is damaged (${data.damaged}): ${palpate.getAgain}`);
    else if (data.organ)
      palpate.page =
          new Page(new Surface(data.organ, palpate.onCard ? 2 : 1), data.organ.touches, gl, worker);
    else if (data.preparing === undefined)
      palpate.page.heard(data);
  };
  worker.postMessage(
      {field: byId('field-bytes').textContent, organ: byId('organ-bytes').textContent});
}

function begin() {
  palpate.begun = true;
  if (palpate.trouble) return;
  if (typeof WebAssembly !== 'object')
    return palpate.stop(
        'this page needs WebAssembly, which this browser does not offer: ' +
        'allow it in the settings (strict security modes turn it off), ' +
        'or open the page in another browser');
  if (typeof DecompressionStream !== 'function' || typeof Worker !== 'function')
    return palpate.stop(palpate.tooOld);
  palpate.onCard = !drawsBySoftware();
  const canvas = byId('organ');
  const gl = canvas.getContext('webgl', {antialias: palpate.onCard, alpha: false});
  if (!gl)
    return palpate.stop(
        'this page needs WebGL, which this browser does not offer: ' +
        'turn on hardware acceleration in the settings and reload the page, ' +
        'or open it in another browser. On a phone, save the file and open it in a browser, ' +
        'not in the preview of a mail');
  let isOnlyTrouble = false;
  canvas.addEventListener('webglcontextlost', (event) => {
    event.preventDefault();  // allows the context to come back
    isOnlyTrouble = !palpate.trouble;
    palpate.stop(
        'the graphics of this device stopped, perhaps because another program uses them: ' +
        'wait a moment, or reload the page');
  });
  canvas.addEventListener('webglcontextrestored', () => {
    if (!palpate.page) return location.reload();
    palpate.page.restored();
    if (isOnlyTrouble) palpate.goOn();
  });
  startField(gl);
}
begin();
