// Whether a hand could notice the error of a force, by the rule of `palpate view`
// (viewer/picture/touch_words.cpp).

// Of a bound, in the force. NaN: there is none.
const errorShare = ({force, bound}) => bound / Math.max(length(force), facts.error.floor);
const isUncertain = (felt) => errorShare(felt) > facts.error.noticeable;
