// Decides whether a hand could notice the error of a force, by the same rule as `palpate view`
// (viewer/picture/touch_words.cpp).

// Error bound relative to the force; NaN if there is no bound.
const errorShare = ({force, bound}) => bound / Math.max(length(force), facts.error.floor);
const isUncertain = (felt) => errorShare(felt) > facts.error.noticeable;
