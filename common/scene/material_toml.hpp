#pragma once

#include <span>

#include "common/scene/material.hpp"

/// [material] and [[region]] as text: which keys each law takes, read and written from one table.
namespace palpate {

class TomlSection;

/// Every key that some law takes, and `group`.
std::span<const std::string_view> materialKeys();

/// Reads and checks a material. Fibre directions are normalised. Error (bad input) for a key that
/// the law does not take, saying which it takes, and for every value that material.hpp excludes.
Material readMaterial(const TomlSection& section);

/// The lines of its keys, `law` first; read again as the same material, bit for bit.
std::string materialToml(const Material& material);

/// The law and its numbers in one line, for people: "mooney-rivlin, c10 = 1300 Pa, c01 = 1280 Pa".
std::string inWords(const Material& material);

}  // namespace palpate
