#pragma once

#include "viewer/report/dataset_facts.hpp"

namespace palpate {

/// A property and its values in two datasets, in words.
struct ComparedProperty {
  std::string name, first, second;
};

/// Returns the bodies, materials, workspaces and sizes of two datasets side by side.
std::vector<ComparedProperty> comparedProperties(const std::vector<Dataset>& datasets,
                                                 const std::vector<DatasetFacts>& facts);

}  // namespace palpate
