#pragma once

#include <span>

#include "common/scene/material.hpp"

/// Reads and writes [material] and [[region]]. One table of keys per law serves both directions.
namespace palpate {

class TomlSection;

/// Returns every key that some law takes, and `group`.
std::span<const std::string_view> materialKeys();

/// Reads and checks a material. Fibre directions are normalised. Error (bad input) for a key that
/// the law does not take (the message lists its keys), and for every value that material.hpp
/// excludes.
Material readMaterial(const TomlSection& section);

/// Returns the lines of its keys, `law` first. They read back as the same material, bit for bit.
std::string materialToml(const Material& material);

/// Returns the law and its numbers on one line: "mooney-rivlin, c10 = 1300 Pa, c01 = 1280 Pa".
std::string inWords(const Material& material);

}  // namespace palpate
