// A virtual hand. It presses at a place to the wanted depth and retreats after letting go, as fast
// as the hand of `palpate view`.
class Hand {
  // reach: largest radius of a workspace, m.
  constructor(reach) {
    const wanted = Math.min(facts.hand.usualDepth, facts.hand.usualShare * reach);
    Object.assign(this, {place: null, held: false, depth: 0, wanted, sideways: [0, 0, 0]});
  }
  begin(place) { Object.assign(this, {place, held: true, sideways: [0, 0, 0]}); }
  letGo() { this.held = false; }
  advance(seconds) {
    const goal = this.held ? this.wanted : 0,
          rate = this.held ? facts.hand.pressRate : facts.hand.releaseRate;
    this.depth += (goal - this.depth) * (1 - Math.exp(-rate * seconds));
    if (Math.abs(this.depth - goal) < 2e-6) this.depth = goal;
    if (!this.held) {
      this.sideways = scaled(this.sideways, Math.exp(-rate * seconds));
      if (this.depth < 1e-4) {
        this.place = null;
        this.depth = 0;
      }
    }
  }
  // Returns the displacement of the tool, m, limited to a workspace of this radius.
  displacement(radius) {
    const p = add(scaled(this.place.normal, -this.depth), this.sideways), size = length(p);
    return size > radius ? scaled(p, radius / size) : p;
  }
}
