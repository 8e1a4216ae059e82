#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "scheduler/service/status.hpp"
#include "scheduler/verbs/status_text.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {
namespace {

/// Returns the bytes of a status with its maps in a fixed order, which Protobuf does not ensure by
/// default.
std::string deterministicBytes(const wire::Status& status) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream to(&bytes);
    google::protobuf::io::CodedOutputStream out(&to);
    out.SetSerializationDeterministic(true);
    require(status.SerializeToCodedStream(&out), "a status cannot be written");
  }
  return bytes;
}

/// The output of `status` for any answer from a server.
void readStatus(std::string_view bytes) {
  const wire::Status status = statusFromJson(std::string(bytes), "a");
  describe(status);
  progressLine(status);
  require(deterministicBytes(statusFromJson(toJson(status), "a")) == deterministicBytes(status),
          "a status is not read as it was written");
}

std::vector<std::string> statusSeeds() {
  wire::Status status;
  status.set_scene("liver");
  status.set_build("0123456789abcdef0123456789abcdef");
  status.set_state("running");
  wire::SpaceStatus& space = *status.add_spaces();
  space.set_name("tip");
  space.set_points(515);
  space.set_unknown(200);
  space.set_expandable(300);
  space.set_failed(15);
  space.set_stage("lattice");
  wire::WorkerStatus& worker = *status.add_workers();
  worker.set_worker("01234567");
  worker.set_host("here");
  worker.set_state("busy");
  status.set_seconds(12.5);
  status.set_eta_seconds(70);
  (*status.mutable_failed_points())["unreachable"] = 3;
  (*status.mutable_counters())["bad_messages"] = 1;
  return {toJson(status)};
}

const Registration status_fuzzer({"status", readStatus, statusSeeds});

}  // namespace
}  // namespace palpate::fuzz
