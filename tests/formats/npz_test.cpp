#include "core/formats/npz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <tuple>

#include "core/base/file.h"
#include "core/formats/array_fields.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Npz SmallNpz() {
  Npz npz;
  npz.members.push_back({"poses", MakeArray({2, 3}, {1, 2, 3, 4, 5, 6}, "<f4"), ""});
  npz.members.push_back({"gender", MakeTextArray("m\xc3\xa4le"), ""});
  return npz;
}

std::string NpzFails(const std::string& bytes, const NpzLimits& limits = {}) {
  const auto npz = ParseNpz(bytes, "a.npz", limits);
  return npz ? "parsed" : npz.error().Message();
}

TEST(Npz, WrittenAndReadAgainIsTheSameAndTheBytesAreTheSame) {
  const auto bytes = EncodeNpz(SmallNpz(), "a.npz");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  EXPECT_EQ(*EncodeNpz(SmallNpz(), "a.npz"), *bytes);
  const auto again = ParseNpz(*bytes, "a.npz");
  ASSERT_TRUE(again) << again.error().Message();
  ASSERT_EQ(again->members.size(), 2u);
  EXPECT_EQ(again->members[0].name, "poses");
  EXPECT_EQ(again->members[0].array.dtype, "<f4");
  EXPECT_THAT(again->Find("poses")->values, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(again->Find("gender")->texts, ElementsAre("m\xc3\xa4le"));
  EXPECT_EQ(again->Find("trans"), nullptr);
}

TEST(Npz, TheTimeOfDayDoesNotReachTheFile) {
  const std::string bytes = EncodeNpz(SmallNpz(), "a.npz").value();
  EXPECT_EQ(bytes.substr(10, 4), std::string("\0\0\x21\0", 4)) << "1980-01-01 00:00";
  setenv("TZ", "Pacific/Auckland", 1);
  EXPECT_EQ(EncodeNpz(SmallNpz(), "a.npz").value(), bytes);
  unsetenv("TZ");
}

TEST(Npz, AnArchiveWithoutMembersIsEmpty) {
  const auto empty = ParseNpz(EncodeNpz({}, "a.npz").value(), "a.npz");
  ASSERT_TRUE(empty) << empty.error().Message();
  EXPECT_TRUE(empty->members.empty());
}

TEST(Npz, MembersOfObjectsAreSkippedAndForeignFilesIgnored) {
  std::string object = WriteNpy(MakeArray({1}, {0}));
  object.replace(object.find("<f8"), 3, "|O ");
  object.replace(object.find("|O "), 3, "|O'").erase(object.find("|O'") + 3, 1);
  const auto npz = ParseNpz(
      WriteStoredZip({{"notes.txt", "x"}, {"vids.npy", object}, {"a.npy", WriteNpy(MakeArray({1}, {7}))}}, "z").value(),
      "a.npz");
  ASSERT_TRUE(npz) << npz.error().Message();
  ASSERT_EQ(npz->members.size(), 2u);
  EXPECT_THAT(npz->members[0].skipped, HasSubstr("|O"));
  EXPECT_EQ(npz->Find("vids"), nullptr);
  EXPECT_THAT(npz->Find("a")->values, ElementsAre(7));
}

/// An array of one object, which is this pickle.
std::string ObjectsOf(const std::string& pickle) {
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }";
  header += std::string(64 - (10 + header.size() + 1) % 64, ' ') + "\n";
  return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) + '\0' + header + pickle;
}

TEST(Npz, AMemberThatNamesAClassBesidePlainDataIsToldWithItAndTheOthersAreRead) {
  const char* const kEvil = "cos\nsystem\n(S'touch evil'\ntR.";
  const std::string plain = WriteNpy(MakeArray({1}, {7}));
  for (const auto& [member, content, told] :
       {std::tuple<std::string, std::string, std::string>{"a.npy", ObjectsOf(kEvil),
                                                          "a.npz:a: byte 11: the file names 'os system'"},
        {"archive/data.pkl", kEvil, "a.npz:archive/data.pkl: byte 11: the file names 'os system'"},
        {"a.npy", ObjectsOf("(ios\nsystem\n."),
         "a.npz:a: byte 1: opcode 0x69 (INST) is not among those of plain data"}}) {
    const auto npz = ParseNpz(WriteStoredZip({{member, content}, {"b.npy", plain}}, "z").value(), "a.npz");
    ASSERT_TRUE(npz) << npz.error().Message();
    EXPECT_THAT(npz->Find("b")->values, ElementsAre(7));
    ASSERT_EQ(npz->unsafe.size(), 1u) << member;
    EXPECT_EQ(npz->unsafe[0].reason, Reason::kUnsafePickle);
    EXPECT_THAT(npz->unsafe[0].Message(), HasSubstr(told));
  }
  const auto ragged = ParseNpz(WriteStoredZip({{"a.npy", ObjectsOf("(lI1\na.")}}, "z").value(), "a.npz");
  ASSERT_TRUE(ragged);
  EXPECT_TRUE(ragged->unsafe.empty()) << "lists and numbers are plain data";
  EXPECT_THAT(ParseNpy(ObjectsOf(kEvil), "a.npy").error().Message(), HasSubstr("'os system'"));
  EXPECT_FALSE(std::filesystem::exists("evil"));
}

TEST(Npz, ABadMemberIsNamed) {
  const std::string good = EncodeNpz(SmallNpz(), "a.npz").value();
  std::string damaged = good;
  damaged[damaged.find("NUMPY") + 130] ^= 1;  // a value of poses: the checksum tells
  EXPECT_THAT(NpzFails(damaged), HasSubstr("a.npz:poses"));
  EXPECT_THAT(NpzFails(good.substr(0, good.size() - 30)), HasSubstr("a.npz: no zip archive"));
  EXPECT_THAT(NpzFails(""), HasSubstr("the file is empty"));
  EXPECT_THAT(NpzFails(WriteStoredZip({{"trans.npy", "x"}}, "z").value()), HasSubstr("a.npz:trans"));
  EXPECT_THAT(NpzFails(WriteStoredZip({{"trans.npy", WriteNpy(MakeArray({1}, {7})).substr(0, 130)}}, "z").value()),
              HasSubstr("a.npz:trans: shape (1,) announces 1, the file holds 0"));
}

TEST(Npz, WhatIsUnpackedIsBounded) {
  NpzLimits limits;
  limits.zip.bytes = 100;
  EXPECT_THAT(NpzFails(EncodeNpz(SmallNpz(), "a.npz").value(), limits), HasSubstr("more than 100 bytes when unpacked"));
  limits = {};
  limits.numbers = 5;
  EXPECT_THAT(NpzFails(EncodeNpz(SmallNpz(), "a.npz").value(), limits), HasSubstr("more than 5 numbers"));
  limits = {};
  limits.zip.members = 1;
  EXPECT_THAT(NpzFails(EncodeNpz(SmallNpz(), "a.npz").value(), limits), HasSubstr("2 members"));
}

TEST(Npz, APackedArchiveIsRead) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto bytes = ReadFile(std::filesystem::path(data) / "pose2sim/reference_3d_own_dlt.npz");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  const auto npz = ParseNpz(*bytes, "reference");
  ASSERT_TRUE(npz) << npz.error().Message();
  ASSERT_NE(npz->Find("single"), nullptr);
  EXPECT_THAT(npz->Find("single")->shape, ElementsAre(80, 25, 3));
}

}  // namespace
}  // namespace mocurate
