#include "common/wire/bundle.hpp"

#include <utility>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Returns the payload length that the message gives, bytes.
std::size_t payloadBytesOf(const wire::Message& message) {
  switch (message.body_case()) {
    case wire::Message::kResult: return message.result().payload_bytes();
    case wire::Message::kProblemReply: return message.problem_reply().payload_bytes();
    case wire::Message::kFieldsReply: return message.fields_reply().payload_bytes();
    case wire::Message::kFollowRequest: return message.follow_request().payload_bytes();
    default: return 0;
  }
}

}  // namespace

void Bundler::add(wire::Message message, std::string_view payload) {
  PALPATE_ASSERT(payload.size() == payloadBytesOf(message), "a message must announce its payload");
  PALPATE_ASSERT(!message.has_bundle(), "a bundle must not contain a bundle");
  const std::size_t bytes = message.ByteSizeLong() + payload.size();
  if (bytes_ + bytes > bundle_bytes || open_.message.bundle().messages_size() == bundle_messages)
    close();
  *open_.message.mutable_bundle()->add_messages() = std::move(message);
  open_.payload += payload;
  bytes_ += bytes;
}

void Bundler::close() {
  if (!open_.message.has_bundle()) return;
  Letter letter = std::exchange(open_, {});
  bytes_ = 0;
  if (letter.message.bundle().messages_size() == 1) {
    wire::Message only = std::move(*letter.message.mutable_bundle()->mutable_messages(0));
    letter.message = std::move(only);
  }
  closed_.push_back(std::move(letter));
}

std::vector<Letter> Bundler::take() {
  close();
  PALPATE_ASSERT(bytes_ == 0 && open_.payload.empty(), "a payload must leave with its message");
  return std::exchange(closed_, {});
}

std::vector<Incoming> unbundled(Incoming incoming) {
  std::vector<Incoming> parts;
  if (!incoming.message.has_bundle()) {
    parts.push_back(std::move(incoming));
    return parts;
  }
  wire::Bundle bundle = std::move(*incoming.message.mutable_bundle());
  const std::string payload = std::move(incoming.payload);
  incoming.message.Clear();
  incoming.payload.clear();
  std::size_t wanted = 0;
  for (const wire::Message& message : bundle.messages()) wanted += payloadBytesOf(message);
  if (bundle.messages().empty() || bundle.messages_size() > bundle_messages ||
      wanted != payload.size()) {
    parts.push_back(std::move(incoming));
    return parts;
  }
  std::size_t at = 0;
  for (wire::Message& message : *bundle.mutable_messages()) {
    Incoming& part = parts.emplace_back(incoming);
    incoming.bytes = 0;
    part.payload = payload.substr(at, payloadBytesOf(message));
    at += part.payload.size();
    if (!message.has_bundle() && isReadable(message)) part.message = std::move(message);
  }
  PALPATE_ASSERT(at == payload.size(), "the payloads must have the announced sizes");
  return parts;
}

}  // namespace palpate
