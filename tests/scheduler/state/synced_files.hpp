#pragma once

#include <string>
#include <vector>

namespace palpate::test {

/// The names of files that this program syncs by fdatasync(), while a test wants to know
/// (journal_test.cpp stands in the place of the C library's).
extern std::vector<std::string>* synced_files;

}  // namespace palpate::test
