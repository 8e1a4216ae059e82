#include "common/space/configuration.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {
namespace {

/// The first byte is the number of nodes, the second the number of pressures.
void readNodalFields(std::string_view bytes) {
  Choices choices(bytes);
  const std::size_t n_nodes = choices.take(), n_pressures = choices.take();
  const std::string_view encoded = choices.rest();
  const NodalFields fields = NodalFields::decode(encoded, n_nodes, n_pressures);
  require(fields.encode() == encoded, "fields are not written as they were read");
}

std::vector<std::string> nodalFieldsSeeds() {
  const NodalFields fields = {{0.1f, -0.2f, 0, 1e-3f, 3, 4}, {101}};
  Script script;
  script.op(2).op(1);
  return {script.text() + fields.encode()};
}

const Registration nodal_fields_fuzzer({"nodal_fields", readNodalFields, nodalFieldsSeeds});

}  // namespace
}  // namespace palpate::fuzz
