// Texts of the page: hints, and the numbers of a touch.
class Words {
  // reach: depth to which the hand can press, m.
  constructor(touches, reach) {
    this.touches = touches;
    this.digits = reach < 0.01 ? 2 : 1;
    const spots = touches.filter((touch) => touch.fingerRadius === 0).length;
    this.spot = spots === 0 ? '' : spots === 1 ? 'at the marked place' : 'at a marked place';
    this.byFinger = matchMedia('(pointer: coarse)').matches;
    this.rest();
  }
  millimetres(metres) { return `${(1000 * metres).toFixed(this.digits)} mm`; }
  say(text) { byId('hint').textContent = text; }
  rest() {
    const how = this.byFinger ?
        'with a finger; the slider sets the depth. Two fingers turn it and zoom.' :
        'with the mouse; the wheel sets the depth. Beside it, drag to turn and scroll to zoom.';
    this.say(`Press the organ ${this.spot || 'anywhere'} ${how}`);
  }
  pressed(byMouse) {
    this.say(`Move to explore; use the ${byMouse ? 'wheel' : 'slider'} to press deeper.`);
  }
  untouchable() {
    this.say(
        this.spot ? `No force was computed here: press ${this.spot}.` :
                    'The organ is fixed here, or no force was computed: press another place.');
  }
  // felt: null without a touch.
  show(felt) {
    const write = (id, text) => {
      if (byId(id).textContent !== text) byId(id).textContent = text;
    };
    write('force', (felt ? length(felt.force) : 0).toFixed(2));
    write(
        'bound',
        felt && Number.isFinite(felt.bound) ?
            `± ${felt.bound.toFixed(felt.bound < 0.095 ? 3 : 2)}` :
            '');
    write('about', felt ? this.about(felt) : 'Not touching');
    byId('numbers').classList.toggle('uncertain', felt !== null && isUncertain(felt));
  }
  about(felt) {
    const {touch, p, energy, inside, coverage} = felt;
    if (!inside) return 'Outside the computed range: this force is a guess';
    if (coverage < 0.5) return 'Near the limit of the computed range: do not rely on this force';
    if (isUncertain(felt))
      return `uncertain: ± ${(100 * errorShare(felt)).toFixed(0)} %, ` +
          `a hand notices ${+(100 * facts.error.noticeable).toPrecision(6)} %`;
    const where = this.touches[touch].fingerRadius > 0 ? 'deep' : 'from rest';
    return `${this.millimetres(length(p))} ${where}, ${(1000 * energy).toFixed(1)} mJ stored`;
  }
}
