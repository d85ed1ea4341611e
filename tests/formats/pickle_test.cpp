#include "core/formats/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"
#include "pickle_samples.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

class EveryProtocol : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProtocol, ReadsTheSameValues) {
  const std::string bytes = FromHex(GetParam());
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  const PickleRef top = pickle->top();
  const auto array = top.Key("a")->Array();
  ASSERT_TRUE(array) << array.error().Message();
  EXPECT_THAT(array->shape, ElementsAre(1, 2));
  EXPECT_EQ(array->dtype, "<f4");
  EXPECT_THAT(array->values, ElementsAre(1.5, -2));
  EXPECT_EQ(top.Key("s")->Number().value(), 2.5);
  EXPECT_EQ(top.Key("t")->Text().value(), "h\xc3\xa9");
  const PickleRef list = *top.Key("n");
  ASSERT_EQ(list.kind(), PickleKind::kList);
  ASSERT_EQ(list.size(), 5u);
  EXPECT_EQ(list.Item(0).kind(), PickleKind::kNone);
  EXPECT_EQ(list.Item(1).kind(), PickleKind::kBool);
  EXPECT_EQ(list.Item(2).Integer().value(), -7);
  EXPECT_EQ(list.Item(3).kind(), PickleKind::kBytes);
  EXPECT_EQ(list.Item(3).value().text, "\xff");
  EXPECT_EQ(list.Item(4).kind(), PickleKind::kTuple);
  EXPECT_EQ(list.Item(4).Item(1).Number().value(), 2);
}

INSTANTIATE_TEST_SUITE_P(Pickle, EveryProtocol,
                         ::testing::Values(kPickleP0, kPickleP1, kPickleP2, kPickleP3, kPickleP4, kPickleP5));

TEST(Pickle, ReadsAPython2File) {
  const std::string bytes = FromHex(kPicklePy2);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  EXPECT_THAT(pickle->top().Key("a")->Array()->values, ElementsAre(1.5, -3));
  EXPECT_EQ(pickle->top().Key("name")->Text().value(), "hi");
}

TEST(Pickle, ConvertsFortranOrderAndBigEndianArrays) {
  const std::string bytes = FromHex(kPickleFortran);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  const auto array = pickle->top().Array();
  EXPECT_THAT(array->shape, ElementsAre(2, 3));
  EXPECT_THAT(array->values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Pickle, ReadsJoblibArraysBetweenTheOpcodes) {
  const std::string bytes = FromHex(kPickleJoblib);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  EXPECT_THAT(pickle->top().Key("x")->Array()->values, ElementsAre(1, 2, 3, 4));
  ExpectError(ParsePickle("\x78\x9c packed", "p.pkl"), ErrorCode::kUnsupported, "p.pkl");
}

TEST(Pickle, ReadsTheEntriesOfSparseMatrices) {
  for (const char* digits : {kPickleCsc, kPickleCsr}) {
    const std::string bytes = FromHex(digits);
    const auto pickle = ParsePickle(bytes, "p.pkl");
    ASSERT_TRUE(pickle) << pickle.error().Message();
    const auto matrix = pickle->top().Sparse();
    ASSERT_TRUE(matrix) << matrix.error().Message();
    EXPECT_EQ(matrix->rows, 2u);
    EXPECT_EQ(matrix->columns, 2u);
    double dense[2][2] = {};
    for (std::size_t i = 0; i < matrix->value.size(); ++i) dense[matrix->row[i]][matrix->column[i]] += matrix->value[i];
    EXPECT_EQ(dense[0][1], 2);
    EXPECT_EQ(dense[1][0], 3);
    EXPECT_EQ(dense[0][0] + dense[1][1], 0);
  }
}

TEST(Pickle, RejectsASparseMatrixWithAnEntryOutOfRange) {
  std::string bytes = FromHex(kPickleCsc);  // the indices 1, 0 are the first array of 32-bit numbers
  const std::size_t at = bytes.find(std::string("\x01\0\0\0\0\0\0\0", 8));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 9;
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  ExpectMalformed(pickle->top().Sparse(), "p.pkl:/indices");
}

TEST(Pickle, ReadsTheNumbersOfAChumpyArray) {
  for (const char* digits : {kPickleCh0, kPickleCh2}) {
    const std::string bytes = FromHex(digits);
    const auto pickle = ParsePickle(bytes, "p.pkl");
    ASSERT_TRUE(pickle) << pickle.error().Message();
    EXPECT_THAT(pickle->top().Key("v")->Array()->values, ElementsAre(1, 2));
  }
}

TEST(Pickle, ReadsASetAsAList) {
  for (const std::string bytes : {"c__builtin__\nset\n((lI1\naI2\natR.", "\x80\x04\x8f(K\x01K\x02\x90."}) {
    const auto pickle = ParsePickle(bytes, "p.pkl");
    ASSERT_TRUE(pickle) << pickle.error().Message();
    EXPECT_EQ(pickle->top().size(), 2u);
  }
  ExpectMalformed(ParsePickle("c__builtin__\nset\n)R.", "p.pkl"), "p.pkl: byte 19");
}

TEST(Pickle, RejectsClassesAndOpcodesThatCouldRunCode) {
  for (const auto& [bytes, where] :
       {std::pair<std::string, const char*>{"cposix\nsystem\n(S'touch evil'\ntR.", "p.pkl: byte 14"},
        {"\x80\x04\x8c\x02os\x8c\x06system\x93\x8c\x04"
         "echo\x85R.",
         "p.pkl: byte 15"},
        {"c__builtin__\neval\n.", "p.pkl: byte 18"},
        {"cnumpy\nload\n.", "p.pkl: byte 12"},
        {"cnumpy\nndarray\n)R.", "p.pkl: byte 17"},
        {"(iposix\nsystem\n.", "p.pkl: byte 1"},
        {"\x80\x02\x82\x01.", "p.pkl: byte 2"},
        {"\x80\x05\x97.", "p.pkl: byte 2"},
        {"\x80\x02K\x01Q.", "p.pkl: byte 5"},
        {"\x80\x09N.", "p.pkl: byte 2"}}) {
    ExpectError(ParsePickle(bytes, "p.pkl"), ErrorCode::kUnsupported, where);
  }
  EXPECT_EQ(ParsePickle("(iposix\nsystem\n.", "p").error().reason, Reason::kUnsafePickle) << "INST creates an instance";
  EXPECT_FALSE(std::filesystem::exists("evil"));
}

TEST(Pickle, RejectsContradictionsWithTheirPlace) {
  const auto altered = [](const std::string& from, const std::string& to) {
    const std::string bytes = FromHex(kPickleP2);
    return std::string(bytes).replace(bytes.find(from), from.size(), to);
  };
  for (const auto& [bytes, where] : {std::pair<std::string, const char*>{"", "p.pkl"},
                                     {"\x80\x02K", "p.pkl: byte 3"},
                                     {"\x80\x02K\x01", "p.pkl: byte 4"},
                                     {"h\x05.", "p.pkl: byte 2"},
                                     {"\x80\x02X\xff\xff\xff\x7f.", "p.pkl: byte 7"},
                                     {std::string("\x80\x02X\x01\0\0\0\xff.", 9), "p.pkl: byte 8"},
                                     {"Ixyz\n.", "p.pkl: byte 5"},
                                     {"(.", "p.pkl: byte 2"},
                                     {".", "p.pkl: byte 1"},
                                     {altered("K\x01K\x02\x86", "K\x01K\x03\x86"), "p.pkl: byte 229"}}) {
    ExpectMalformed(ParsePickle(bytes, "p.pkl"), where);
  }
  ExpectError(ParsePickle(altered("f4", "c8"), "p.pkl"), ErrorCode::kUnsupported, "p.pkl: byte 165");
}

TEST(Pickle, RejectsRecursiveExpandingAndDeeplyNestedContainers) {
  std::string bomb = "]q";
  bomb += '\0';
  for (char i = 1; i < 40; ++i) {  // each list contains the previous one twice
    bomb += std::string("](h") + static_cast<char>(i - 1) + "h" + static_cast<char>(i - 1) + "eq" + i;
  }
  std::string texts = "Vx\np0\n0V" + std::string(1000000, 'y') + "\np1\n0Vlatin1\np2\n0";
  for (int i = 0; i < 1000; ++i) texts += "c_codecs\nencode\n(g1\ng2\ntR0";
  ExpectError(ParsePickle(std::string("]q\0h\0a.", 7), "p.pkl"), ErrorCode::kUnsupported, "p.pkl: byte 7");
  for (const std::string& bytes :
       {bomb + ".", ")" + std::string(100000, '\x85') + ".", std::string(5000000, ')') + ".", texts + "N."}) {
    const auto pickle = ParsePickle(bytes, "p.pkl");
    ASSERT_FALSE(pickle) << bytes.size() << " bytes";
    EXPECT_EQ(pickle.error().code, ErrorCode::kUnsupported);
  }
}

TEST(Pickle, RoundTripsThroughTheWriter) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("list");
  writer.BeginList();
  const std::int64_t integers[] = {0, 255, 256, -1, 2147483647, -2147483648LL, 4294967296LL, INT64_MIN, INT64_MAX};
  for (const std::int64_t integer : integers) writer.Integer(integer);
  writer.Float(-0.1);
  writer.Bool(true);
  writer.None();
  writer.Text("\xe2\x82\xac");
  writer.BeginTuple();
  writer.Integer(3);
  writer.End();
  writer.End();
  writer.Text("real");
  writer.Array(MakeArray({2, 1}, {0.1, -1e300}));
  writer.Text("whole");
  writer.Array(MakeArray({2}, {1, 4294967295.0}, ">u4"));
  writer.Text("none");
  writer.Array(MakeArray({0, 3}, {}));
  writer.Text("text");
  writer.Array(MakeTextArray("h\xc3\xa9"));
  writer.End();
  const auto bytes = writer.Finish("p.pkl");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  const auto pickle = ParsePickle(*bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  const PickleRef top = pickle->top(), list = *top.Key("list");
  for (std::size_t i = 0; i < std::size(integers); ++i) EXPECT_EQ(list.Item(i).Integer().value(), integers[i]);
  EXPECT_EQ(list.Item(9).Number().value(), -0.1);
  EXPECT_EQ(list.Item(10).kind(), PickleKind::kBool);
  EXPECT_EQ(list.Item(11).kind(), PickleKind::kNone);
  EXPECT_EQ(list.Item(12).Text().value(), "\xe2\x82\xac");
  EXPECT_EQ(list.Item(13).Item(0).Integer().value(), 3);
  EXPECT_THAT(top.Key("real")->Array()->values, ElementsAre(0.1, -1e300));
  EXPECT_EQ(top.Key("whole")->Array()->dtype, ">u4");
  EXPECT_THAT(top.Key("whole")->Array()->values, ElementsAre(1, 4294967295.0));
  EXPECT_THAT(top.Key("none")->Array()->shape, ElementsAre(0, 3));
  EXPECT_THAT(top.Key("text")->Array()->texts, ElementsAre("h\xc3\xa9"));
}

TEST(Pickle, IndexesAnArrayWithFewValues) {
  const auto values = [](int arrays) {
    PickleWriter writer;
    writer.BeginList();
    for (int i = 0; i < arrays; ++i) writer.Array(MakeArray({2, 3}, {1, 2, 3, 4, 5, 6}));
    writer.End();
    const std::string bytes = writer.Finish("many").value();
    return ParsePickle(bytes, "many").value().values.size();
  };
  EXPECT_LE(values(1001) - values(1), 1000u * 25u);
  PickleWriter writer;
  writer.BeginList();
  for (int i = 0; i < 1000; ++i) writer.Integer(i % 100);
  for (int i = 0; i < 1000; ++i) writer.Bool(i % 2 == 0);
  writer.End();
  const std::string bytes = writer.Finish("constants").value();
  const auto pickle = ParsePickle(bytes, "constants");
  EXPECT_LT(pickle->values.size(), 110u) << "small numbers and truth values are one value each";
  EXPECT_EQ(pickle->top().Item(250).Integer().value(), 50);
  EXPECT_EQ(pickle->top().Item(1001).Integer().value(), 0);
}

TEST(Pickle, RefusesToWriteWhatDoesNotFit) {
  PickleWriter writer;
  writer.Array(MakeArray({3}, {1}));
  ExpectError(writer.Finish("p.pkl"), ErrorCode::kInconsistent, "p.pkl");
  PickleWriter open;
  open.BeginList();
  ExpectError(open.Finish("p.pkl"), ErrorCode::kInconsistent, "p.pkl");
}

TEST(Pickle, NamesThePathOfAMissingKeyOrWrongType) {
  const std::string bytes = FromHex(kPickleP2);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle);
  ExpectMalformed(pickle->top().Key("pose"), "p.pkl:/");
  ExpectMalformed(pickle->top().Key("t")->Array(), "p.pkl:/t");
  ExpectMalformed(pickle->top().Key("n")->Item(4).Text(), "p.pkl:/n/4");
}

TEST(Pickle, ReadsTheCamerasOfPhspd) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  for (const char* file : {"CamParams0906.pkl", "CamParams0909.pkl"}) {
    const auto bytes = ReadFile(std::filesystem::path(data) / "cameras/phspd" / file);
    ASSERT_TRUE(bytes) << bytes.error().Message();
    const auto pickle = ParsePickle(*bytes, file);
    ASSERT_TRUE(pickle) << pickle.error().Message();
    const auto p1w = pickle->top().Key("p1w")->Array();
    ASSERT_TRUE(p1w) << p1w.error().Message();
    ASSERT_EQ(p1w->shape.size(), 2u);
    EXPECT_EQ(p1w->shape[1], 7u) << "quaternion and translation";
    double norm = 0.0;
    for (int i = 0; i < 4; ++i) norm += p1w->values[i] * p1w->values[i];
    EXPECT_NEAR(norm, 1.0, 1e-3);
  }
}

}  // namespace
}  // namespace mocurate
