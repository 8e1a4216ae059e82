#include "common/scene/material_toml.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.hpp"
#include "common/scene/toml_section.hpp"
#include "common/scene/toml_text.hpp"

namespace palpate {
namespace {

enum class Sign { positive, not_negative, any };

/// A numerical key of a material.
struct NumberKey {
  std::string_view key;
  double Material::*member;
  Sign sign;
  std::string_view unit, meaning;
};

constexpr NumberKey young = {"young", &Material::young, Sign::positive, "Pa",
                             "Young's modulus, Pa"};
constexpr NumberKey c10 = {"c10", &Material::c10, Sign::positive, "Pa",
                           "the factor of I1 - 3 in the energy, Pa"};
constexpr NumberKey c01 = {"c01", &Material::c01, Sign::not_negative, "Pa",
                           "the second Mooney-Rivlin constant, Pa (0: neo-Hookean)"};
constexpr NumberKey c20 = {"c20", &Material::c20, Sign::any, "Pa",
                           "the factor of (I1 - 3)^2 in the energy, Pa"};
constexpr NumberKey c30 = {"c30", &Material::c30, Sign::not_negative, "Pa",
                           "the factor of (I1 - 3)^3 in the energy, Pa"};
constexpr NumberKey mu = {"mu", &Material::mu, Sign::positive, "Pa", "the shear modulus, Pa"};
constexpr NumberKey c1 = {"c1", &Material::c1, Sign::positive, "Pa",
                          "the factor of the exponential in the energy, Pa"};
constexpr NumberKey c2 = {"c2", &Material::c2, Sign::positive, "",
                          "the factor of I1 - 3 in the exponent, a number"};
constexpr NumberKey k1 = {"k1", &Material::k1, Sign::positive, "Pa",
                          "the stiffness of the fibres, Pa"};
constexpr NumberKey k2 = {"k2", &Material::k2, Sign::positive, "",
                          "the factor in the exponent of the fibres, a number"};

/// Returns the numerical keys of a law. The keys of Ogden's terms hold lists and are not included.
std::vector<NumberKey> numbersOf(LawName law) {
  switch (law) {
    case LawName::linear:
    case LawName::st_venant_kirchhoff:
    case LawName::modified_st_venant_kirchhoff: return {young};
    case LawName::mooney_rivlin: return {c10, c01};
    case LawName::neo_hookean: return {mu};
    case LawName::yeoh: return {c10, c20, c30};
    case LawName::ogden: return {};
    case LawName::veronda_westmann: return {c1, c2};
    case LawName::holzapfel_gasser_ogden: return {mu, k1, k2};
  }
  return {};
}

bool takesYoung(LawName law) {
  return isCompressible(law) || law == LawName::modified_st_venant_kirchhoff;
}

/// Keys that a law requires, and further keys that it accepts.
struct Keys {
  std::vector<std::string_view> needed, optional;
};

Keys keysOf(LawName law) {
  Keys keys;
  for (const NumberKey& number : numbersOf(law)) keys.needed.push_back(number.key);
  if (takesYoung(law))
    (law == LawName::modified_st_venant_kirchhoff ? keys.optional : keys.needed)
        .emplace_back("poisson");
  if (law == LawName::ogden) keys.needed = {"mu", "alpha"};
  if (law == LawName::holzapfel_gasser_ogden) {
    keys.needed.emplace_back("fiber");
    keys.optional.emplace_back("dispersion");
  }
  if (!takesYoung(law)) keys.optional.emplace_back("bulk");
  keys.optional.emplace_back("density");
  return keys;
}

void refuseKeysOfOtherLaws(const TomlSection& section, LawName law) {
  const Keys keys = keysOf(law);
  std::vector<std::string_view> taken = {"law", "group", "box", "sphere"};
  for (const auto& some : {keys.needed, keys.optional})
    taken.insert(taken.end(), some.begin(), some.end());
  for (const std::string_view key : material_keys)
    if (section.has(key) && std::ranges::find(taken, key) == taken.end())
      throw section.wrong(key, "law \"{}\" does not use this key; it requires {}, and accepts {}",
                          word(law), listed(keys.needed, "and"), listed(keys.optional, "and"));
}

double numberOf(const TomlSection& section, const NumberKey& number) {
  const auto reading =
      number.sign == Sign::positive ? &TomlSection::positive : &TomlSection::number;
  const double value = section.require(number.key, number.meaning, reading);
  if (number.sign == Sign::not_negative && value < 0)
    throw section.wrong(number.key, "must not be negative, but is {}", value);
  return value;
}

double poissonOf(const TomlSection& section) {
  const double poisson = section.require(
      "poisson", "Poisson's ratio, greater than -1 and less than 0.5", &TomlSection::number);
  if (!(poisson > -1 && poisson < 0.5))
    throw section.wrong(
        "poisson",
        "must be greater than -1 and less than 0.5, not {} (for an incompressible tissue use "
        "modified-st-venant-kirchhoff, mooney-rivlin or another law)",
        poisson);
  return poisson;
}

std::vector<OgdenTerm> ogdenTerms(const TomlSection& section) {
  const auto mus = section.require("mu", "a list of 1 to 3 moduli, Pa, one for each term",
                                   &TomlSection::numbers);
  const auto alphas = section.require("alpha", "a list of exponents, one for each term of mu",
                                      &TomlSection::numbers);
  if (mus.empty() || mus.size() > 3)
    throw section.wrong("mu", "{} terms; 1 to 3 are possible", mus.size());
  if (alphas.size() != mus.size())
    throw section.wrong("alpha", "{} exponents for the {} moduli of mu", alphas.size(), mus.size());
  std::vector<OgdenTerm> terms;
  for (std::size_t i = 0; i < mus.size(); ++i) {
    terms.push_back({mus[i], alphas[i]});
    if (!(mus[i] * alphas[i] > 0))
      throw section.wrong("mu", "term {}: mu * alpha = {} * {} must be greater than 0", i + 1,
                          mus[i], alphas[i]);
  }
  return terms;
}

/// Returns the direction as a unit vector. Unit vectors are returned unchanged.
Eigen::Vector3d directionOf(const TomlSection& section, const toml::node& node) {
  Eigen::Vector3d direction = section.vector("fiber", node);
  if (direction.isZero(0)) throw section.wrong("fiber", "[0, 0, 0] has no direction");
  // Do not normalise a unit vector again. Round-off could change it, and with it the id of the
  // scene.
  if (std::abs(direction.squaredNorm() - 1) < 1e-14) return direction;
  return direction.stableNormalized();
}

void readFibers(const TomlSection& section, Material& material) {
  const toml::node& node = section.require(
      "fiber", "a direction [x, y, z], two of them, or the name of element vectors of the mesh");
  if (node.is_string()) {
    material.fiber_field = section.text("fiber", node);
    return;
  }
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty())
    throw section.wrong("fiber",
                        "write [x, y, z], [[x, y, z], [x, y, z]], or the name of element vectors");
  // A single direction may be written without the outer brackets, as [x, y, z].
  if (!array->get(0)->is_array()) {
    material.fibers = {directionOf(section, node)};
    return;
  }
  if (array->size() > 2)
    throw section.wrong("fiber", "{} directions; 1 or 2 are possible", array->size());
  for (const toml::node& direction : *array)
    material.fibers.push_back(directionOf(section, direction));
}

double dispersionOf(const TomlSection& section) {
  const double dispersion = section.optional("dispersion", &TomlSection::number).value_or(0);
  if (!(dispersion >= 0 && dispersion <= 1.0 / 3))
    throw section.wrong("dispersion",
                        "must be between 0 (aligned) and 1/3 (in all directions), not {}",
                        dispersion);
  return dispersion;
}

std::string fibersToml(const Material& m) {
  if (!m.fiber_field.empty()) return quotedToml(m.fiber_field);
  const auto direction = [](const Eigen::Vector3d& fiber) { return decimalToml(fiber); };
  return fmt::format("[{}]", fmt::join(mapped(m.fibers, direction), ", "));
}

std::string listToml(const std::vector<OgdenTerm>& terms, double OgdenTerm::*member) {
  const auto value = [member](const OgdenTerm& term) { return decimalToml(term.*member); };
  return fmt::format("[{}]", fmt::join(mapped(terms, value), ", "));
}

/// A key, its value as TOML, and the unit of the value ("" for a pure number).
struct Entry {
  std::string_view key;
  std::string value;
  std::string_view unit;
};

std::vector<Entry> entriesOf(const Material& m) {
  std::vector<Entry> entries;
  for (const NumberKey& number : numbersOf(m.law))
    entries.push_back({number.key, decimalToml(m.*number.member), number.unit});
  if (takesYoung(m.law) && m.poisson) entries.push_back({"poisson", decimalToml(*m.poisson), ""});
  if (m.law == LawName::ogden) {
    entries.push_back({"mu", listToml(m.ogden, &OgdenTerm::mu), "Pa"});
    entries.push_back({"alpha", listToml(m.ogden, &OgdenTerm::alpha), ""});
  }
  if (m.law == LawName::holzapfel_gasser_ogden) {
    entries.push_back({"dispersion", decimalToml(m.dispersion), ""});
    entries.push_back({"fiber", fibersToml(m), ""});
  }
  if (m.bulk) entries.push_back({"bulk", decimalToml(*m.bulk), "Pa"});
  if (m.density) entries.push_back({"density", decimalToml(*m.density), "kg/m^3"});
  return entries;
}

}  // namespace

Material readMaterial(const TomlSection& section) {
  Material m;
  section.require("law", fmt::format("write one of {}", listed(words_of<LawName>)));
  m.law = section.choice("law", m.law);
  refuseKeysOfOtherLaws(section, m.law);
  for (const NumberKey& number : numbersOf(m.law)) m.*number.member = numberOf(section, number);
  if (takesYoung(m.law) &&
      (m.law != LawName::modified_st_venant_kirchhoff || section.has("poisson")))
    m.poisson = poissonOf(section);
  if (m.law == LawName::ogden) m.ogden = ogdenTerms(section);
  if (m.law == LawName::holzapfel_gasser_ogden) {
    readFibers(section, m);
    m.dispersion = dispersionOf(section);
  }
  m.bulk = section.optional("bulk", &TomlSection::positive);
  m.density = section.optional("density", &TomlSection::positive);
  return m;
}

std::string materialToml(const Material& material) {
  std::string text = fmt::format("law = \"{}\"\n", word(material.law));
  for (const Entry& entry : entriesOf(material))
    text += entry.unit.empty() ? fmt::format("{} = {}\n", entry.key, entry.value)
                               : fmt::format("{} = {}  # {}\n", entry.key, entry.value, entry.unit);
  return text;
}

std::string inWords(const Material& material) {
  std::string text(word(material.law));
  for (const auto& [key, value, unit] : entriesOf(material)) {
    // Remove ".0", which only TOML needs.
    const std::size_t end = value.ends_with(".0") ? value.size() - 2 : value.size();
    text += fmt::format(", {} = {}{}{}", key, value.substr(0, end), unit.empty() ? "" : " ", unit);
  }
  return text;
}

}  // namespace palpate
