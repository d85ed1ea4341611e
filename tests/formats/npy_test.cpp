#include "core/formats/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

std::string NpyFile(const std::string& descr, const std::string& shape, const std::string& data, int version = 1,
                    const std::string& order = "False") {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) bytes += static_cast<char>((header.size() >> (8 * i)) & 0xFF);
  return bytes + header + data;
}

template <class T>
std::string BytesOfNumbers(std::initializer_list<T> values, bool big_endian = false) {
  std::string bytes;
  for (const T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big_endian ? sizeof(T) - 1 - i : i];
  }
  return bytes;
}

TEST(Npy, ReadsTheSameNumbersFromAllTypesByteOrdersAndVersions) {
  const std::string files[] = {NpyFile("<f4", "(2, 2)", BytesOfNumbers<float>({1, -2, 3, 4})),
                               NpyFile(">f4", "(2,2)", BytesOfNumbers<float>({1, -2, 3, 4}, true), 2),
                               NpyFile("<f8", "(2, 2)", BytesOfNumbers<double>({1, -2, 3, 4}), 3),
                               NpyFile(">i4", "(2, 2)", BytesOfNumbers<std::int32_t>({1, -2, 3, 4}, true)),
                               NpyFile("<i8", "(2, 2)", BytesOfNumbers<std::int64_t>({1, -2, 3, 4}))};
  for (const std::string& bytes : files) {
    const auto array = ParseNpy(bytes, "p.npy");
    ASSERT_TRUE(array) << array.error().Message();
    EXPECT_THAT(array->shape, ElementsAre(2, 2));
    EXPECT_THAT(array->values, ElementsAre(1, -2, 3, 4));
  }
}

TEST(Npy, ConvertsFortranOrderToCOrder) {
  const auto array =
      ParseNpy(NpyFile("<i4", "(2, 3)", BytesOfNumbers<std::int32_t>({0, 10, 1, 11, 2, 12}), 1, "True"), "p.npy");
  ASSERT_TRUE(array) << array.error().Message();
  EXPECT_THAT(array->values, ElementsAre(0, 1, 2, 10, 11, 12));
}

TEST(Npy, RoundTripsThroughTheWriter) {
  NpyArray array;
  array.shape = {3};
  array.dtype = "<f8";
  array.values = {0.1, 2, -3e300};
  const auto again = ParseNpy(WriteNpy(array), "p.npy");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->values, array.values);
  EXPECT_EQ(again->shape, array.shape);
}

TEST(Npy, RoundTripsEveryNumericTypeInBothByteOrders) {
  const std::vector<std::pair<std::string, std::vector<double>>> types = {
      {"|b1", {0, 1, 1, 0}},
      {"|i1", {-128, 127, 0, 5}},
      {"|u1", {0, 255, 1, 2}},
      {"<i2", {-32768, 32767, 0, 5}},
      {"<u2", {0, 65535, 1, 2}},
      {"<i4", {-2147483648.0, 2147483647, 0, 5}},
      {"<u4", {0, 4294967295.0, 1, 2}},
      {"<i8", {-9007199254740992.0, 1, 2, 3}},
      {"<u8", {9007199254740992.0, 1, 2, 3}},
      {"<f2", {-0.5, 65504, 6.103515625e-05, 5.9604644775390625e-08}},
      {"<f4", {-0.5, 1e30f, 3, 0.1f}},
      {"<f8", {-0.5, 1e300, 3, 0.1}}};
  for (const auto& [name, values] : types) {
    for (const char order : {'<', '>'}) {
      NpyArray array;
      array.dtype = name[0] == '|' ? name : order + name.substr(1);
      array.shape = {2, 2};
      array.values = values;
      const auto bytes = EncodeNpy(array, "p.npy");
      ASSERT_TRUE(bytes) << bytes.error().Message();
      const auto again = ParseNpy(*bytes, "p.npy");
      ASSERT_TRUE(again) << again.error().Message();
      EXPECT_EQ(again->dtype, array.dtype);
      EXPECT_EQ(again->shape, array.shape);
      EXPECT_EQ(again->values, values) << array.dtype;
    }
  }
}

TEST(Npy, RoundsHalfPrecisionToNearestEven) {
  NpyArray array;
  array.dtype = "<f2";
  array.shape = {5};
  array.values = {0.1, 2049, 2051, 1e6, 2.9e-8};
  const auto again = ParseNpy(EncodeNpy(array, "p").value(), "p");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->values[0], 0.0999755859375);
  EXPECT_EQ(again->values[1], 2048);
  EXPECT_EQ(again->values[2], 2052);
  EXPECT_TRUE(std::isinf(again->values[3]));
  EXPECT_EQ(again->values[4], 0.0);
}

TEST(Npy, ReadsTextsAsUnicodeAndBytes) {
  const auto unicode =
      ParseNpy(NpyFile("<U3", "(2,)", std::string("a\0\0\0\xe9\0\0\0\0\0\0\0x\0\0\0y\0\0\0\xac\x20\0\0", 24)), "p");
  ASSERT_TRUE(unicode) << unicode.error().Message();
  EXPECT_THAT(unicode->texts, ElementsAre("a\xc3\xa9", "xy\xe2\x82\xac"));
  EXPECT_TRUE(unicode->values.empty());
  const auto big = ParseNpy(NpyFile(">U1", "()", std::string("\0\0\0a", 4)), "p");
  ASSERT_TRUE(big) << big.error().Message();
  EXPECT_THAT(big->texts, ElementsAre("a"));
  const auto bytes = ParseNpy(NpyFile("|S4", "(2,)", std::string("maleC7\0\0", 8)), "p");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  EXPECT_THAT(bytes->texts, ElementsAre("male", "C7"));
  for (const auto& array : {*unicode, *big, *bytes}) {
    const auto again = ParseNpy(EncodeNpy(array, "p").value(), "p");
    ASSERT_TRUE(again) << again.error().Message();
    EXPECT_EQ(again->texts, array.texts);
    EXPECT_EQ(again->dtype, array.dtype);
  }
  ExpectMalformed(ParseNpy(NpyFile("<U1", "(1,)", std::string("\0\0\x11\0", 4)), "p.npy"), "p.npy");
}

TEST(Npy, RefusesToWriteAValueOutsideItsType) {
  const auto write = [](const std::string& dtype, double value) {
    NpyArray array;
    array.dtype = dtype;
    array.values = {value};
    return EncodeNpy(array, "p.npy");
  };
  ExpectMalformed(write("|u1", 256), "p.npy");
  ExpectMalformed(write("<i4", 0.5), "p.npy");
  ExpectMalformed(write("|b1", 2), "p.npy");
  ExpectError(write("<c16", 2), ErrorCode::kUnsupported, "p.npy");
  EXPECT_TRUE(write("<u8", 18446744073709549568.0));
}

TEST(Npy, RejectsBadInput) {
  using Code = ErrorCode;
  for (const auto& [bytes, code] :
       {std::pair<std::string, Code>{"", Code::kMalformed},
        {"PK\x03\x04 zipped arrays", Code::kMalformed},
        {NpyFile("<f4", "(2, 2)", BytesOfNumbers<float>({1, 2, 3})), Code::kInconsistent},
        {NpyFile("<f4", "(4611686018427387904, 4)", BytesOfNumbers<float>({1})), Code::kInconsistent},
        {NpyFile("|O", "(1,)", "\x80\x03"), Code::kUnsupported},
        {NpyFile("<c8", "(1,)", "12345678"), Code::kUnsupported},
        {NpyFile("<f4", "(1,)", "1234", 9), Code::kUnsupported},
        {std::string("\x93NUMPY\x01\x00\xFF\xFF{", 11), Code::kMalformed}}) {
    ExpectError(ParseNpy(bytes, "p.npy"), code, "p.npy");
  }
  ExpectMalformed(ParseNpy(NpyFile("<f4", "(1,", "1234"), "p.npy"), "p.npy:byte 53");
}

}  // namespace
}  // namespace mocurate
