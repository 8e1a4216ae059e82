#include "common/keys/key_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "tests/support/child.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using testing::ElementsAre;
using testing::Pair;

struct KeyFolderTest : testing::Test {
  test::TemporaryDirectory directory;
  const KeyFolder folder{directory / "config" / "keys"};

  static Roles roles(const char* words) { return rolesOf(words); }
  static mode_t modeOf(const std::filesystem::path& path) {
    struct stat info {};
    EXPECT_EQ(stat(path.c_str(), &info), 0) << path;
    return info.st_mode & 07777;
  }
  void write(const char* file, const std::string& text) const {
    std::ofstream(folder.path() / file) << text;
    ASSERT_EQ(chmod((folder.path() / file).c_str(), 0600), 0);
  }
};

TEST(KeyPair, HasThePublicKeyOfItsSecret) {
  // RFC 7748, section 6.1: Bob.
  const auto secret =
      Bytes32::fromHex("5dab087e624a8a4b79e17f8b83800ee66f3bb1292618b6fd1c2f8b27ff88e0eb");
  ASSERT_TRUE(secret);
  EXPECT_EQ(KeyPair(*secret).open().hex(),
            "de9edb7d7b7dc1b4d35b61c2ece435373f8343c85b78674dadfc7e146f882b4f");
  EXPECT_NE(KeyPair::make().secret(), KeyPair::make().secret());
}

TEST(PublicKey, IsSixtyFourHexadecimalDigitsAndNothingElse) {
  const PublicKey key = KeyPair::make().open();
  EXPECT_EQ(PublicKey::fromHex(key.hex()), key);
  for (const std::string& wrong : {std::string(), key.hex().substr(1), key.hex() + "0",
                                   "g" + key.hex().substr(1), " " + key.hex().substr(1)})
    EXPECT_FALSE(PublicKey::fromHex(wrong)) << wrong;
  EXPECT_FALSE(PublicKey::fromBytes(std::string(31, 'x')));
}

TEST(Roles, AnOperatorIsAnObserverToo) {
  EXPECT_TRUE(include(rolesOf("operator"), Roles::observer));
  EXPECT_FALSE(include(rolesOf("operator"), Roles::worker));
  EXPECT_FALSE(include(rolesOf("worker,observer"), Roles::system_operator));
  EXPECT_EQ(rolesOf("operator,worker"), Roles::all);
  for (const Roles roles : {Roles::worker, Roles::system_operator, Roles::all})
    EXPECT_EQ(rolesOf(wordsOf(roles)), roles);
  EXPECT_EQ(wordsOf(Roles::system_operator), "operator");
}

TEST(Roles, UnknownRolesAreRefusedWithTheListOfValidOnes) {
  for (const char* wrong : {"", "root", "worker,", "worker operator", "simulator"})
    expectBadInput([&] { rolesOf(wrong); }, {"worker, observer, operator"});
}

TEST_F(KeyFolderTest, MakesAKeyThatNobodyElseCanRead) {
  EXPECT_FALSE(folder.hasOwn());
  expectBadInput([&] { folder.own(); }, {"own.key", "palpate key new"});
  const PublicKey key = folder.ownOrNew().open();
  EXPECT_EQ(folder.own().open(), key);
  EXPECT_EQ(folder.ownOrNew().open(), key) << "once";
  EXPECT_EQ(modeOf(folder.path()), 0700);
  EXPECT_EQ(modeOf(folder.path() / "own.key"), 0600);
  EXPECT_NE(folder.replaceOwn().open(), key);
}

TEST_F(KeyFolderTest, ConcurrentCreationsGetTheSameKey) {
  for (int round = 0; round < 20; ++round) {
    const KeyFolder shared(directory / std::to_string(round));
    const pid_t child = test::startChild([&] {
      shared.ownOrNew();
      return 0;
    });
    const PublicKey made = shared.ownOrNew().open();
    EXPECT_EQ(test::codeOf(child), 0);
    EXPECT_EQ(shared.own().open(), made);
  }
}

TEST_F(KeyFolderTest, KeepsConcurrentAdmissionsAndWithdrawals) {
  folder.ownOrNew();
  constexpr int processes = 20;
  for (int n = 0; n < processes; ++n)
    folder.allow({KeyPair::make().open(), roles("worker"), "gone" + std::to_string(n)});
  std::vector<pid_t> children;
  for (int n = 0; n < processes; ++n) {
    children.push_back(test::startChild([&] {
      folder.allow({KeyPair::make().open(), roles("worker"), "new" + std::to_string(n)});
      folder.trust(KeyPair::make().open(), "tcp://host:" + std::to_string(1 + n));
      return folder.withdraw("gone" + std::to_string(n)) ? 0 : 1;
    }));
  }
  for (const pid_t child : children) EXPECT_EQ(test::codeOf(child), 0);
  EXPECT_EQ(folder.servers().size(), std::size_t{processes});
  const std::vector<AllowedKey> left = folder.allowed();
  EXPECT_EQ(left.size(), std::size_t{processes});
  for (const AllowedKey& key : left) EXPECT_EQ(key.name.substr(0, 3), "new");
}

TEST_F(KeyFolderTest, IsRefusedIfOthersCouldReadOrChangeIt) {
  folder.ownOrNew();
  ASSERT_EQ(chmod(folder.path().c_str(), 0750), 0);
  expectBadInput([&] { folder.own(); }, {"chmod 0700", folder.path().string()});
  ASSERT_EQ(chmod(folder.path().c_str(), 0700), 0);
  for (const char* file : {"own.key", "allowed", "servers"}) {
    if (std::string(file) != "own.key") write(file, "");
    ASSERT_EQ(chmod((folder.path() / file).c_str(), 0640), 0);
    expectBadInput([&] { folder.own(), folder.allowed(), folder.servers(); }, {"chmod 0600", file});
    ASSERT_EQ(chmod((folder.path() / file).c_str(), 0600), 0);
  }
}

TEST_F(KeyFolderTest, NamesAnInvalidLine) {
  folder.ownOrNew();
  const std::string key = KeyPair::make().open().hex();
  write("allowed", "# nobody\n\n" + key + " worker,king node\n");
  expectBadInput([&] { folder.allowed(); }, {"allowed:3", "\"king\""});
  write("allowed", key.substr(1) + " worker\n");
  expectBadInput([&] { folder.allowed(); }, {"allowed:1", "64"});
  write("servers", key + "\n");
  expectBadInput([&] { folder.servers(); }, {"servers:1", "endpoint"});
  write("own.key", "secret\n");
  expectBadInput([&] { folder.own(); }, {"own.key", "--replace"});
}

TEST_F(KeyFolderTest, KeepsAdmittedKeysUntilTheyAreWithdrawn) {
  const PublicKey first = KeyPair::make().open(), second = KeyPair::make().open();
  folder.allow({first, roles("worker"), "node one"});
  folder.allow({second, roles("observer"), ""});
  folder.allow({first, roles("worker,operator"), "node 1"});
  ASSERT_EQ(folder.allowed().size(), 2U);
  EXPECT_EQ(folder.allowed()[1].name, "node 1");
  EXPECT_TRUE(include(folder.allowed()[1].roles, Roles::system_operator));
  EXPECT_EQ(modeOf(folder.allowedFile()), 0600);
  EXPECT_TRUE(folder.withdraw("node 1"));
  EXPECT_TRUE(folder.withdraw(second.hex()));
  EXPECT_FALSE(folder.withdraw(second.hex()));
  EXPECT_TRUE(folder.allowed().empty());
}

TEST_F(KeyFolderTest, RefusesANameThatWouldAdmitAnotherKey) {
  const PublicKey key = KeyPair::make().open(), other = KeyPair::make().open();
  for (const std::string& name : {"node\n" + other.hex() + " operator", std::string("node # 1")})
    expectBadInput([&] { folder.allow({key, roles("worker"), name}); }, {"not a name"});
  folder.allow({key, roles("worker"), ""});
  EXPECT_FALSE(folder.withdraw("")) << "an empty name is invalid";
  EXPECT_EQ(folder.allowed().size(), 1U);
}

TEST_F(KeyFolderTest, FindsAServersKeyByEndpointThenStarThenOwnKey) {
  const PublicKey own = folder.ownOrNew().open();
  const PublicKey one = KeyPair::make().open(), any = KeyPair::make().open();
  EXPECT_EQ(folder.serverAt("tcp://head:7411"), own);
  folder.trust(any, "*");
  folder.trust(KeyPair::make().open(), "tcp://head:7411");
  folder.trust(one, "tcp://head:7411");
  EXPECT_EQ(folder.serverAt("tcp://head:7411"), one);
  EXPECT_EQ(folder.serverAt("tcp://other:7411"), any);
  EXPECT_THAT(folder.servers(), ElementsAre(Pair("*", any), Pair("tcp://head:7411", one)));
}

TEST_F(KeyFolderTest, IsChosenByOptionVariableOrHome) {
  EXPECT_EQ(chosenKeyFolder("here").path(), "here");
  setenv("PALPATE_KEYS", "/from/variable", 1);
  EXPECT_EQ(chosenKeyFolder("").path(), "/from/variable");
  unsetenv("PALPATE_KEYS");
  setenv("XDG_CONFIG_HOME", "/config", 1);
  EXPECT_EQ(chosenKeyFolder("").path(), "/config/palpate/keys");
  unsetenv("XDG_CONFIG_HOME");
  setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(chosenKeyFolder("").path(), "/home/somebody/.config/palpate/keys");
  unsetenv("HOME");
  expectBadInput([] { chosenKeyFolder(""); }, {"HOME", "--keys", "PALPATE_KEYS"});
}

struct AdmissionTest : KeyFolderTest {
  const PublicKey own = folder.ownOrNew().open(), other = KeyPair::make().open();

  static bool eventuallyLets(Admission& admission, const PublicKey& key, bool in) {
    for (int tries = 0; tries < 500; ++tries) {
      if ((admission.rolesOf(key) != Roles::none) == in) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
};

TEST_F(AdmissionTest, AllowsTheOwnKeyEverythingAndStrangersNothing) {
  Admission admission(folder);
  EXPECT_EQ(admission.rolesOf(own), Roles::all);
  EXPECT_EQ(admission.rolesOf(other), Roles::none);
}

TEST_F(AdmissionTest, FollowsAdmissionsAndWithdrawalsWhileItRuns) {
  Admission admission(folder);
  folder.allow({other, roles("worker"), "node"});
  EXPECT_TRUE(eventuallyLets(admission, other, true));
  EXPECT_EQ(admission.rolesOf(other), roles("worker"));
  folder.withdraw("node");
  EXPECT_TRUE(eventuallyLets(admission, other, false));
}

TEST_F(AdmissionTest, KeepsTheLastValidListIfANewOneIsInvalid) {
  folder.allow({other, roles("worker"), "node"});
  Admission admission(folder);
  write("allowed", "nonsense\n");
  const PublicKey third = KeyPair::make().open();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_NE(admission.rolesOf(other), Roles::none);
  write("allowed", third.hex() + " observer\n");
  EXPECT_TRUE(eventuallyLets(admission, third, true));
  EXPECT_EQ(admission.rolesOf(other), Roles::none);
}

}  // namespace
}  // namespace palpate
