#pragma once

#include <string>
#include <vector>

namespace palpate::test {

/// If not null, collects the names of files that this program syncs by fdatasync().
/// journal_test.cpp replaces the function of the C library.
extern std::vector<std::string>* synced_files;

}  // namespace palpate::test
