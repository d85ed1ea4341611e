#include "core/formats/npz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <tuple>

#include "core/base/file.h"
#include "core/formats/array_fields.h"
#include "core/formats/pickle.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

Npz SmallNpz() {
  Npz npz;
  npz.members.push_back({"poses", MakeArray({2, 3}, {1, 2, 3, 4, 5, 6}, "<f4"), ""});
  npz.members.push_back({"gender", MakeTextArray("m\xc3\xa4le"), ""});
  return npz;
}

TEST(Npz, RoundTripsToTheSameBytes) {
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

TEST(Npz, WritesNoTimeOfDay) {
  const std::string bytes = EncodeNpz(SmallNpz(), "a.npz").value();
  EXPECT_EQ(bytes.substr(10, 4), std::string("\0\0\x21\0", 4)) << "1980-01-01 00:00";
  setenv("TZ", "Pacific/Auckland", 1);
  EXPECT_EQ(EncodeNpz(SmallNpz(), "a.npz").value(), bytes);
  unsetenv("TZ");
}

TEST(Npz, ReadsAnArchiveWithoutMembersAsEmpty) {
  const auto empty = ParseNpz(EncodeNpz({}, "a.npz").value(), "a.npz");
  ASSERT_TRUE(empty) << empty.error().Message();
  EXPECT_TRUE(empty->members.empty());
}

TEST(Npz, SkipsObjectMembersAndIgnoresOtherFiles) {
  std::string object = WriteNpy(MakeArray({1}, {0}));
  object.replace(object.find("<f8"), 3, "|O ");
  object.replace(object.find("|O "), 3, "|O'").erase(object.find("|O'") + 3, 1);
  const auto npz = ParseNpz(
      WriteStoredZip({{"notes.txt", "x"}, {"vids.npy", object}, {"a.npy", WriteNpy(MakeArray({1}, {7}))}}, "z").value(),
      "a.npz");
  ASSERT_TRUE(npz) << npz.error().Message();
  ASSERT_EQ(npz->members.size(), 2u);
  EXPECT_FALSE(npz->members[0].skipped.empty());
  EXPECT_EQ(npz->Find("vids"), nullptr);
  EXPECT_THAT(npz->Find("a")->values, ElementsAre(7));
}

/// A one-object array that contains this pickle.
std::string ObjectsOf(const std::string& pickle) {
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }";
  header += std::string(64 - (10 + header.size() + 1) % 64, ' ') + "\n";
  return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) + '\0' + header + pickle;
}

TEST(Npz, ReportsAMemberThatNamesAClassAndReadsTheOthers) {
  const char* const kEvil = "cos\nsystem\n(S'touch evil'\ntR.";
  const std::string plain = WriteNpy(MakeArray({1}, {7}));
  for (const auto& [member, content, where] :
       {std::tuple<std::string, std::string, std::string>{"a.npy", ObjectsOf(kEvil), "a.npz:a: byte 11"},
        {"archive/data.pkl", kEvil, "a.npz:archive/data.pkl: byte 11"},
        {"a.npy", ObjectsOf("(ios\nsystem\n."), "a.npz:a: byte 1"}}) {
    const auto npz = ParseNpz(WriteStoredZip({{member, content}, {"b.npy", plain}}, "z").value(), "a.npz");
    ASSERT_TRUE(npz) << npz.error().Message();
    EXPECT_THAT(npz->Find("b")->values, ElementsAre(7));
    ASSERT_EQ(npz->unsafe.size(), 1u) << member;
    EXPECT_EQ(npz->unsafe[0].reason, Reason::kUnsafePickle);
    EXPECT_EQ(npz->unsafe[0].where, where);
  }
  const auto ragged = ParseNpz(WriteStoredZip({{"a.npy", ObjectsOf("(lI1\na.")}}, "z").value(), "a.npz");
  ASSERT_TRUE(ragged);
  EXPECT_TRUE(ragged->unsafe.empty()) << "lists and numbers are plain data";
  ExpectError(ParseNpy(ObjectsOf(kEvil), "a.npy"), ErrorCode::kUnsupported, "a.npy: byte 11");
  EXPECT_FALSE(std::filesystem::exists("evil"));
}

TEST(Npz, NamesABadMember) {
  const std::string good = EncodeNpz(SmallNpz(), "a.npz").value();
  std::string damaged = good;
  damaged[damaged.find("NUMPY") + 130] ^= 1;  // a value of poses: the checksum fails
  const std::string cut = WriteNpy(MakeArray({1}, {7})).substr(0, 130);
  ExpectMalformed(ParseNpz(damaged, "a.npz"), "a.npz:poses.npy");
  ExpectMalformed(ParseNpz(good.substr(0, good.size() - 30), "a.npz"), "a.npz");
  ExpectMalformed(ParseNpz("", "a.npz"), "a.npz");
  ExpectMalformed(ParseNpz(WriteStoredZip({{"trans.npy", "x"}}, "z").value(), "a.npz"), "a.npz:trans");
  ExpectError(ParseNpz(WriteStoredZip({{"trans.npy", cut}}, "z").value(), "a.npz"), ErrorCode::kInconsistent,
              "a.npz:trans");
}

TEST(Npz, LimitsTheUnpackedSize) {
  const std::string bytes = EncodeNpz(SmallNpz(), "a.npz").value();
  NpzLimits few_bytes, few_numbers, few_members;
  few_bytes.zip.bytes = 100;
  few_numbers.numbers = 5;
  few_members.zip.members = 1;
  ExpectError(ParseNpz(bytes, "a.npz", few_bytes), ErrorCode::kUnsupported, "a.npz:poses.npy");
  ExpectError(ParseNpz(bytes, "a.npz", few_numbers), ErrorCode::kUnsupported, "a.npz:poses");
  ExpectError(ParseNpz(bytes, "a.npz", few_members), ErrorCode::kUnsupported, "a.npz");
}

TEST(Npz, LimitsWhatAnArchiveOfItsSizeMayUnpackTo) {
  std::string bytes = WriteStoredZip({{"a.npy", WriteNpy(MakeArray({1}, {7}))}}, "z").value();
  const std::size_t entry = bytes.find("PK\x01\x02");
  bytes.replace(entry + 24, 4, std::string("\0\0\0\x20", 4));  // declares 512 MiB
  bytes.replace(22, 4, std::string("\0\0\0\x20", 4));
  ExpectError(ParseNpz(bytes, "a.npz"), ErrorCode::kUnsupported, "a.npz:a.npy");
}

TEST(Npz, ReadsACompressedArchive) {
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
