#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Returns the names of the methods of makeForceField, the default first.
const std::vector<std::string>& forceFieldMethods();

/// Returns the field that interpolates `space` by a method. Error (bad input) for an unknown
/// method, listing the known ones. Error if the space has no solved point, or if the radial
/// functions cannot interpolate its points (rbf_field.hpp). Any thread.
std::unique_ptr<ForceField> makeForceField(std::string_view method, const SpaceTable& space);

}  // namespace palpate
