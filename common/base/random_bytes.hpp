#pragma once

#include <cstddef>
#include <string>

namespace palpate {

/// That many bytes nobody can guess, from the system. Error when it gives none.
std::string randomBytes(std::size_t count);

}  // namespace palpate
