#include "core/formats/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string File(const std::string& descr, const std::string& shape, const std::string& data, int version = 1,
                 const std::string& order = "False") {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) bytes += static_cast<char>((header.size() >> (8 * i)) & 0xFF);
  return bytes + header + data;
}

template <class T>
std::string Bytes(std::initializer_list<T> values, bool big_endian = false) {
  std::string bytes;
  for (const T value : values) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big_endian ? sizeof(T) - 1 - i : i];
  }
  return bytes;
}

std::string Fails(const std::string& bytes) {
  const auto array = ParseNpy(bytes, "p.npy");
  return array ? "parsed" : array.error().Message();
}

TEST(Npy, TypesByteOrdersAndVersionsGiveTheSameNumbers) {
  const std::string files[] = {File("<f4", "(2, 2)", Bytes<float>({1, -2, 3, 4})),
                               File(">f4", "(2,2)", Bytes<float>({1, -2, 3, 4}, true), 2),
                               File("<f8", "(2, 2)", Bytes<double>({1, -2, 3, 4}), 3),
                               File(">i4", "(2, 2)", Bytes<std::int32_t>({1, -2, 3, 4}, true)),
                               File("<i8", "(2, 2)", Bytes<std::int64_t>({1, -2, 3, 4}))};
  for (const std::string& bytes : files) {
    const auto array = ParseNpy(bytes, "p.npy");
    ASSERT_TRUE(array) << array.error().Message();
    EXPECT_THAT(array->shape, ElementsAre(2, 2));
    EXPECT_THAT(array->values, ElementsAre(1, -2, 3, 4));
  }
}

TEST(Npy, FortranOrderIsTurnedIntoCOrder) {
  const auto array = ParseNpy(File("<i4", "(2, 3)", Bytes<std::int32_t>({0, 10, 1, 11, 2, 12}), 1, "True"), "p.npy");
  ASSERT_TRUE(array) << array.error().Message();
  EXPECT_THAT(array->values, ElementsAre(0, 1, 2, 10, 11, 12));
}

TEST(Npy, WrittenAndReadAgainIsTheSame) {
  NpyArray array;
  array.shape = {3};
  array.dtype = "<f8";
  array.values = {0.1, 2, -3e300};
  const auto again = ParseNpy(WriteNpy(array), "p.npy");
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->values, array.values);
  EXPECT_EQ(again->shape, array.shape);
}

TEST(Npy, BadInputIsRefusedWithReason) {
  EXPECT_EQ(Fails(""), "p.npy: the file is empty");
  EXPECT_THAT(Fails("PK\x03\x04 zipped arrays"), HasSubstr("does not begin as a numpy array"));
  EXPECT_THAT(Fails(File("<f4", "(2, 2)", Bytes<float>({1, 2, 3}))), HasSubstr("the file is cut off"));
  EXPECT_THAT(Fails(File("<f4", "(4611686018427387904, 4)", Bytes<float>({1}))), HasSubstr("more numbers than"));
  EXPECT_THAT(Fails(File("|O", "(1,)", "\x80\x03")), HasSubstr("arrays of type '|O' are not read"));
  EXPECT_THAT(Fails(File("<c8", "(1,)", "12345678")), HasSubstr("'<c8' are not read"));
  EXPECT_THAT(Fails(File("<f4", "(1,", "1234")), HasSubstr("the npy header lacks the shape"));
  EXPECT_THAT(Fails(File("<f4", "(1,)", "1234", 9)), HasSubstr("npy format version 9"));
  EXPECT_THAT(Fails(std::string("\x93NUMPY\x01\x00\xFF\xFF{", 11)), HasSubstr("the header is cut off"));
}

}  // namespace
}  // namespace mocurate
