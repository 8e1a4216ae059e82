#pragma once

#include "viewer/report/dataset_facts.hpp"

namespace palpate {

/// A property of both datasets, in words.
struct ComparedProperty {
  std::string name, first, second;
};

/// Returns body, materials, workspace and size of two datasets side by side.
std::vector<ComparedProperty> comparedProperties(const std::vector<Dataset>& datasets,
                                                 const std::vector<DatasetFacts>& facts);

}  // namespace palpate
