#include <gtest/gtest.h>

#include <vector>

#include "common/base/bytes32.hpp"

namespace palpate {
namespace {

// From: printf abc | b2sum -l 256
constexpr const char* id_of_abc =
    "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319";

TEST(ContentId, IsBlake2b256OfTheBytes) { EXPECT_EQ(ContentId::of("abc").hex(), id_of_abc); }

TEST(ContentId, DoesNotDependOnHowTheBytesArrive) {
  ContentHasher hasher;
  for (const char* piece : {"a", "", "bc"}) hasher.add(piece);
  EXPECT_EQ(hasher.finish(), ContentId::of("abc"));
}

TEST(ContentId, RoundTripsAsHexAndAsBytes) {
  const ContentId id = ContentId::of("abc");
  EXPECT_EQ(ContentId::fromHex(id.hex()), id);
  EXPECT_EQ(ContentId::fromBytes(id.bytes()), id);
  EXPECT_EQ(id.shortHex(), std::string(id_of_abc).substr(0, 12));
}

TEST(ContentId, RefusesInvalidIds) {
  const std::string hex = id_of_abc;
  EXPECT_FALSE(ContentId::fromHex(hex.substr(1)));
  EXPECT_FALSE(ContentId::fromHex(hex + "0"));
  EXPECT_FALSE(ContentId::fromHex("x" + hex.substr(1)));
  EXPECT_FALSE(ContentId::fromBytes(std::string(31, 'a')));
}

TEST(ContentId, HashOfNoBytesIsNotTheEmptyId) {
  EXPECT_NE(ContentId::of(""), ContentId());
  EXPECT_EQ(ContentId().hex(), std::string(64, '0'));
}

TEST(ContentId, BytesOfAnArrayAreItsMemory) {
  const std::vector<std::uint16_t> values = {0x4241, 0x4443};
  EXPECT_EQ(bytesOf(std::span<const std::uint16_t>(values)), "ABCD");
}

}  // namespace
}  // namespace palpate
