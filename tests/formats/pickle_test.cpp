#include "core/formats/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"
#include "pickle_samples.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string PickleFails(const std::string& bytes) {
  const auto pickle = ParsePickle(bytes, "p.pkl");
  return pickle ? "parsed" : pickle.error().Message();
}

class EveryProtocol : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProtocol, GivesTheSameValues) {
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

TEST(Pickle, APython2FileIsRead) {
  const std::string bytes = FromHex(kPicklePy2);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  EXPECT_THAT(pickle->top().Key("a")->Array()->values, ElementsAre(1.5, -3));
  EXPECT_EQ(pickle->top().Key("name")->Text().value(), "hi");
}

TEST(Pickle, FortranOrderAndBigEndianAreTurned) {
  const std::string bytes = FromHex(kPickleFortran);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  const auto array = pickle->top().Array();
  EXPECT_THAT(array->shape, ElementsAre(2, 3));
  EXPECT_THAT(array->values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Pickle, AJoblibFileHoldsItsArraysBetweenTheOpcodes) {
  const std::string bytes = FromHex(kPickleJoblib);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  EXPECT_THAT(pickle->top().Key("x")->Array()->values, ElementsAre(1, 2, 3, 4));
  const PickleRef objects = *pickle->top().Key("o");
  EXPECT_EQ(objects.Layout()->dtype, "|O");
  EXPECT_FALSE(objects.Array());
  EXPECT_THAT(PickleFails("\x78\x9c packed"), HasSubstr("the file is packed (zlib)"));
}

TEST(Pickle, SparseMatricesGiveTheirEntries) {
  for (const char* digits : {kPickleCsc, kPickleCsr, kPickleCoo}) {
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

TEST(Pickle, ASparseMatrixWithAnEntryOutsideIsRefusedByItsPart) {
  std::string bytes = FromHex(kPickleCsc);  // indices are the first array of 32-bit numbers: 1, 0
  const std::size_t at = bytes.find(std::string("\x01\0\0\0\0\0\0\0", 8));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 9;
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  const auto matrix = pickle->top().Sparse();
  ASSERT_FALSE(matrix);
  EXPECT_THAT(matrix.error().Message(), HasSubstr("p.pkl:/indices: entry 0 lies outside"));
}

TEST(Pickle, AChumpyArrayIsItsNumbers) {
  for (const char* digits : {kPickleCh0, kPickleCh2}) {
    const std::string bytes = FromHex(digits);
    const auto pickle = ParsePickle(bytes, "p.pkl");
    ASSERT_TRUE(pickle) << pickle.error().Message();
    EXPECT_THAT(pickle->top().Key("v")->Array()->values, ElementsAre(1, 2));
  }
}

TEST(Pickle, AClassThatIsNoDataIsNamedAndNothingRuns) {
  EXPECT_THAT(PickleFails("cposix\nsystem\n(S'touch evil'\ntR."), HasSubstr("'posix system'"));
  EXPECT_THAT(PickleFails(std::string("\x80\x04\x8c\x02os\x8c\x06system\x93\x8c\x04"
                                      "echo\x85R.")),
              HasSubstr("'os system'"));
  EXPECT_THAT(PickleFails("c__builtin__\neval\n."), HasSubstr("'__builtin__ eval'"));
  EXPECT_THAT(PickleFails("cnumpy\nload\n."), HasSubstr("'numpy load'"));
  EXPECT_FALSE(std::filesystem::exists("evil"));
  EXPECT_THAT(PickleFails("cnumpy\nndarray\n)R."), HasSubstr("'numpy ndarray' is called"));
  EXPECT_EQ(ParsePickle("(iposix\nsystem\n.", "p").error().reason, Reason::kUnsafePickle) << "an opcode that makes one";
  EXPECT_THAT(PickleFails("(iposix\nsystem\n."), HasSubstr("opcode 0x69 (INST)"));
  EXPECT_THAT(PickleFails("\x80\x02\x82\x01."), HasSubstr("opcode 0x82 (EXT1)"));
  EXPECT_THAT(PickleFails("\x80\x05\x97."), HasSubstr("opcode 0x97 (NEXT_BUFFER)"));
  EXPECT_THAT(PickleFails("\x80\x02K\x01Q."), HasSubstr("BINPERSID"));
  EXPECT_THAT(PickleFails("\x80\x09N."), HasSubstr("pickle protocol 9"));
}

TEST(Pickle, WhatContradictsItselfIsRefusedWithItsPlace) {
  EXPECT_THAT(PickleFails(""), HasSubstr("the file is empty"));
  EXPECT_THAT(PickleFails("\x80\x02K"), HasSubstr("the file ends inside a number"));
  EXPECT_THAT(PickleFails("\x80\x02K\x01"), HasSubstr("ends before its pickle"));
  EXPECT_THAT(PickleFails("h\x05."), HasSubstr("object 5 is used before it is defined"));
  EXPECT_THAT(PickleFails("\x80\x02X\xff\xff\xff\x7f."), HasSubstr("a text of 2147483647 bytes"));
  EXPECT_THAT(PickleFails(std::string("\x80\x02X\x01\0\0\0\xff.", 9)), HasSubstr("no UTF-8"));
  EXPECT_THAT(PickleFails("Ixyz\n."), HasSubstr("'xyz' is no integer"));
  EXPECT_THAT(PickleFails("(."), HasSubstr("a container is never ended"));
  EXPECT_THAT(PickleFails("."), HasSubstr("a pickle without a result"));
  std::string shape = FromHex(kPickleP2);
  shape.replace(shape.find("K\x01K\x02\x86"), 5, "K\x01K\x03\x86");
  EXPECT_THAT(PickleFails(shape), HasSubstr("the shape (1, 3) of an array contradicts its 8 bytes"));
  std::string type = FromHex(kPickleP2);
  type.replace(type.find("f4"), 2, "c8");
  EXPECT_THAT(PickleFails(type), HasSubstr("arrays of the type 'c8'"));
}

TEST(Pickle, ContainersThatHoldThemselvesExplodeOrNestWithoutEndAreRefused) {
  EXPECT_THAT(PickleFails(std::string("]q\0h\0a.", 7)), HasSubstr("holds itself"));
  std::string bomb = "]q";
  bomb += '\0';
  for (char i = 1; i < 40; ++i) {  // each list holds the one before it twice
    bomb += std::string("](h") + static_cast<char>(i - 1) + "h" + static_cast<char>(i - 1) + "eq" + i;
  }
  EXPECT_THAT(PickleFails(bomb + "."), HasSubstr("repeated too often"));
  EXPECT_THAT(PickleFails(std::string(")") + std::string(100000, '\x85') + "."), HasSubstr("nested deeper than 64"));
  EXPECT_THAT(PickleFails(std::string(5000000, ')') + "."), HasSubstr("more than 4194304 objects"));
  std::string copies = "(lp0\n(";  // a set made of one long list, a thousand times
  copies += std::string(100000, 'N') + "e";
  for (int i = 0; i < 1000; ++i) copies += "c__builtin__\nset\n(g0\ntR";
  EXPECT_THAT(PickleFails(copies + "."), HasSubstr("more work than"));
  std::string texts = "Vx\np0\n0V" + std::string(1000000, 'y') + "\np1\n0Vlatin1\np2\n0";
  for (int i = 0; i < 1000; ++i) texts += "c_codecs\nencode\n(g1\ng2\ntR0";
  EXPECT_THAT(PickleFails(texts + "N."), HasSubstr("the same bytes are repeated too often"));
}

TEST(Pickle, WhatTheWriterWritesIsReadAgain) {
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

TEST(Pickle, AnArrayCostsTheIndexFewValuesHoweverManyThereAre) {
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

TEST(Pickle, TheWriterRefusesWhatDoesNotFit) {
  PickleWriter writer;
  writer.Array(MakeArray({3}, {1}));
  EXPECT_THAT(writer.Finish("p.pkl").error().Message(), HasSubstr("shape (3,)"));
  PickleWriter open;
  open.BeginList();
  EXPECT_THAT(open.Finish("p.pkl").error().Message(), HasSubstr("not ended"));
}

TEST(Pickle, AMissingKeyOrAWrongKindIsNamedByItsPath) {
  const std::string bytes = FromHex(kPickleP2);
  const auto pickle = ParsePickle(bytes, "p.pkl");
  ASSERT_TRUE(pickle);
  EXPECT_THAT(pickle->top().Key("pose").error().Message(), HasSubstr("p.pkl:/: the key 'pose' is missing"));
  EXPECT_THAT(pickle->top().Key("t")->Array().error().Message(),
              HasSubstr("p.pkl:/t: an array is expected, not a text"));
  EXPECT_THAT(pickle->top().Key("n")->Item(4).Text().error().Message(), HasSubstr("p.pkl:/n/4: a text is expected"));
}

TEST(Pickle, TheCamerasOfPhspdAreRead) {
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
