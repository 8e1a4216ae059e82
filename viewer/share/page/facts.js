'use strict';

// Data of the organ that `palpate share` wrote into the page (viewer/share/organ_page.cpp).

const byId = (id) => document.getElementById(id);
const facts = readFacts();

function readFacts() {
  try {
    return JSON.parse(byId('facts').textContent);
  } catch (error) {
    palpate.stop(
        `this page is damaged (the data of its organ cannot be read): ${palpate.getAgain}`);
    return {};
  }
}
