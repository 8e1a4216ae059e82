#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/scene/material.hpp"

/// Reads and writes [material] and [[region]]. Reading and writing use the same table of keys for
/// each law.
namespace palpate {

class TomlSection;

/// The keys that at least one law accepts, and `group`, `box` and `sphere`.
inline constexpr std::array<std::string_view, 20> material_keys = {
    "law",     "young",      "poisson", "c10",   "c01", "c20",   "c30",
    "mu",      "alpha",      "c1",      "c2",    "k1",  "k2",    "bulk",
    "density", "dispersion", "fiber",   "group", "box", "sphere"};

/// Reads and checks a material. Fibre directions are normalised. Error (bad input) for a key that
/// the law does not accept (the message lists the law's keys), and for every value that
/// material.hpp excludes.
Material readMaterial(const TomlSection& section);

/// Returns the TOML lines of a material, `law` first. readMaterial() reads them back as the same
/// material, bit for bit.
std::string materialToml(const Material& material);

/// Describes a material on one line by its law and numbers: "mooney-rivlin, c10 = 1300 Pa, c01 =
/// 1280 Pa".
std::string inWords(const Material& material);

}  // namespace palpate
