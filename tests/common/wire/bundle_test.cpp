#include "common/wire/bundle.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

wire::Message resultOf(std::uint32_t space, std::size_t payload_bytes) {
  wire::Message message;
  message.mutable_result()->set_space(space);
  message.mutable_result()->set_payload_bytes(static_cast<std::uint32_t>(payload_bytes));
  return message;
}

wire::Message requestFor(std::uint32_t credit) {
  wire::Message message;
  message.mutable_request()->set_credit(credit);
  return message;
}

/// Unpacks a bundle as the receiver does.
std::vector<Incoming> opened(const Letter& letter) {
  Incoming incoming;
  incoming.peer = "peer";
  incoming.message.ParseFromString(letter.message.SerializeAsString());
  incoming.payload = letter.payload;
  incoming.bytes = 1000;
  return unbundled(std::move(incoming));
}

TEST(Bundle, KeepsMessagesInOrderWithTheirPayloads) {
  Bundler bundler;
  bundler.add(resultOf(1, 3), "abc");
  bundler.add(requestFor(2));
  bundler.add(resultOf(3, 2), "de");
  const std::vector<Letter> letters = bundler.take();
  ASSERT_EQ(letters.size(), 1u);
  const std::vector<Incoming> parts = opened(letters[0]);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].message.result().space(), 1u);
  EXPECT_EQ(parts[0].payload, "abc");
  EXPECT_EQ(parts[1].message.request().credit(), 2u);
  EXPECT_EQ(parts[1].payload, "");
  EXPECT_EQ(parts[2].payload, "de");
  for (const Incoming& part : parts) EXPECT_EQ(part.peer, "peer");
  EXPECT_EQ(parts[0].bytes + parts[1].bytes + parts[2].bytes, 1000u);
  EXPECT_TRUE(bundler.take().empty());
}

TEST(Bundle, OneMessageIsSentAsItself) {
  Bundler bundler;
  bundler.add(requestFor(5));
  const std::vector<Letter> letters = bundler.take();
  ASSERT_EQ(letters.size(), 1u);
  EXPECT_EQ(letters[0].message.request().credit(), 5u);
}

TEST(Bundle, IsClosedBeforeItsLimitAndLongMessagesGoAlone) {
  const std::string large(bundle_bytes, 'x'), half(bundle_bytes / 2, 'y');
  Bundler bundler;
  bundler.add(requestFor(1));
  bundler.add(resultOf(0, large.size()), large);
  bundler.add(resultOf(1, half.size()), half);
  bundler.add(resultOf(2, half.size()), half);
  bundler.add(requestFor(2));
  const std::vector<Letter> letters = bundler.take();
  ASSERT_EQ(letters.size(), 4u);
  EXPECT_TRUE(letters[0].message.has_request());
  EXPECT_EQ(letters[1].payload, large);
  EXPECT_EQ(letters[2].payload, half);
  EXPECT_EQ(letters[3].message.bundle().messages_size(), 2);
}

/// The parts of the payload could not be assigned to messages.
TEST(Bundle, IsRefusedIfItsPayloadDoesNotMatchItsMessages) {
  for (const std::size_t payload_bytes :
       {std::size_t{4}, std::size_t{6}, std::size_t{4000000000}}) {
    wire::Message message;
    *message.mutable_bundle()->add_messages() = resultOf(0, payload_bytes);
    *message.mutable_bundle()->add_messages() = requestFor(1);
    const std::vector<Incoming> parts = opened({message, "abcde"});
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].message.body_case(), wire::Message::BODY_NOT_SET);
    EXPECT_EQ(parts[0].payload, "");
  }
}

TEST(Bundle, LosesOnlyUnreadableMessages) {
  wire::Message unknown = requestFor(3), message;
  wire::Request& request = *unknown.mutable_request();
  request.GetReflection()->MutableUnknownFields(&request)->AddVarint(99, 1);
  *message.mutable_bundle()->add_messages() = unknown;
  message.mutable_bundle()->add_messages()->mutable_bundle();
  *message.mutable_bundle()->add_messages() = requestFor(4);
  const std::vector<Incoming> parts = opened({message, ""});
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].message.body_case(), wire::Message::BODY_NOT_SET);
  EXPECT_EQ(parts[1].message.body_case(), wire::Message::BODY_NOT_SET);
  EXPECT_EQ(parts[2].message.request().credit(), 4u);
}

/// A peer with such bundles would be served a thousand times for each turn of the other peers.
TEST(Bundle, WithTooManyMessagesIsNeitherMadeNorRead) {
  Bundler bundler;
  wire::Message message;
  for (int n = 0; n <= bundle_messages; ++n) {
    bundler.add(requestFor(0));
    *message.mutable_bundle()->add_messages() = requestFor(0);
  }
  const std::vector<Letter> letters = bundler.take();
  ASSERT_EQ(letters.size(), 2u);
  EXPECT_EQ(opened(letters[0]).size(), static_cast<std::size_t>(bundle_messages));
  const std::vector<Incoming> parts = opened({message, ""});
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].message.body_case(), wire::Message::BODY_NOT_SET);
}

TEST(Bundle, AnEmptyBundleIsRefused) {
  wire::Message message;
  message.mutable_bundle();
  const std::vector<Incoming> parts = opened({message, ""});
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].message.body_case(), wire::Message::BODY_NOT_SET);
}

TEST(Inbox, UnpacksABundleMessageByMessage) {
  Bundler bundler;
  for (const std::uint32_t credit : {1u, 2u, 3u}) bundler.add(requestFor(credit));
  std::vector<Letter> letters = bundler.take();
  Inbox inbox;
  int calls = 0;
  const auto receive = [&]() -> std::optional<Incoming> {
    if (calls++ > 0) return std::nullopt;
    Incoming incoming;
    incoming.message = letters[0].message;
    return incoming;
  };
  for (const std::uint32_t credit : {1u, 2u, 3u}) {
    const auto incoming = inbox.next(receive);
    ASSERT_TRUE(incoming);
    EXPECT_EQ(incoming->message.request().credit(), credit);
  }
  EXPECT_FALSE(inbox.next(receive));
}

}  // namespace
}  // namespace palpate
