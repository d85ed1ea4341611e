#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/store/hdf5_file.h"
#include "core/store/table.h"
#include "tests/store/builders.h"

namespace mocurate {
namespace {

using store::Field;
using store::Hdf5Id;

/// A file of one schema with every field in it.
struct Kind {
  const char* name;
  const store::Schema* schema;
  std::function<Status(const std::filesystem::path&)> write;
  std::function<Status(const std::filesystem::path&)> read;
};

template <class T>
Status StatusOf(const Expected<T>& read) {
  if (read) return {};
  return Forward(read);
}

const std::vector<Kind>& Kinds() {
  static const std::vector<Kind> kinds = {
      {"dataset", &store::DatasetSchema(), [](const auto& path) { return WriteDataset(test::MakeDataset(), path); },
       [](const auto& path) { return StatusOf(ReadDataset(path)); }},
      {"evidence", &store::EvidenceSchema(),
       [](const auto& path) { return WriteEvidence(test::MakeEvidenceClip(true), path, test::MakeDataset().findings); },
       [](const auto& path) { return StatusOf(ReadEvidence(path)); }},
      {"truth", &store::TruthSchema(), [](const auto& path) { return WriteTruth(test::MakeTruth(), path); },
       [](const auto& path) { return StatusOf(ReadTruth(path)); }}};
  return kinds;
}

bool IsAttribute(const Field& field) { return field.path.rfind("/@", 0) == 0; }

/// Changes a copy of a good file with HDF5 itself.
void Change(const std::filesystem::path& path, const std::function<void(hid_t file)>& change) {
  const Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  ASSERT_TRUE(file.ok());
  change(file.get());
}

void Remove(hid_t file, const Field& field) {
  const herr_t done =
      IsAttribute(field) ? H5Adelete(file, field.path.c_str() + 2) : H5Ldelete(file, field.path.c_str(), H5P_DEFAULT);
  ASSERT_GE(done, 0) << field.path;
}

/// Puts another object of `type` and shape where the field was.
void Replace(hid_t file, const Field& field, hid_t type, const std::vector<hsize_t>& shape) {
  Remove(file, field);
  const Hdf5Id space(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose);
  if (IsAttribute(field)) {
    const Hdf5Id made(H5Acreate2(file, field.path.c_str() + 2, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ASSERT_TRUE(made.ok());
    return;
  }
  const Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  const Hdf5Id made(H5Dcreate2(file, field.path.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                    H5Dclose);
  ASSERT_TRUE(made.ok()) << field.path;
}

std::vector<hsize_t> ShapeOf(hid_t file, const Field& field) {
  const Hdf5Id dataset(H5Dopen2(file, field.path.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Id space(H5Dget_space(dataset.get()), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  if (!shape.empty()) H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

/// Flips the lowest bit of the first byte.
void FlipBit(hid_t file, const Field& field) {
  const bool attribute = IsAttribute(field);
  const Hdf5Id object(
      attribute ? H5Aopen(file, field.path.c_str() + 2, H5P_DEFAULT) : H5Dopen2(file, field.path.c_str(), H5P_DEFAULT),
      attribute ? H5Aclose : H5Dclose);
  const Hdf5Id type(attribute ? H5Aget_type(object.get()) : H5Dget_type(object.get()), H5Tclose);
  const Hdf5Id space(attribute ? H5Aget_space(object.get()) : H5Dget_space(object.get()), H5Sclose);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get()));
  std::vector<char> bytes(H5Tget_size(type.get()) * count);
  ASSERT_FALSE(bytes.empty()) << field.path;
  const auto read = [&] {
    return attribute ? H5Aread(object.get(), type.get(), bytes.data())
                     : H5Dread(object.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  };
  ASSERT_GE(read(), 0);
  bytes[0] = static_cast<char>(bytes[0] ^ 1);
  ASSERT_GE(attribute ? H5Awrite(object.get(), type.get(), bytes.data())
                      : H5Dwrite(object.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
            0);
}

/// The change must be refused with an error that names the file and the field.
void ExpectRefused(const Kind& kind, const std::string& bytes, const Field& field, const char* change_name,
                   const std::function<void(hid_t)>& change) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "changed.h5";
  test::PutBytes(path, bytes);
  Change(path, change);
  const Status read = kind.read(path);
  ASSERT_FALSE(read) << kind.name << ": " << change_name << " " << field.path << " was not noticed";
  EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
  const std::string message = read.error().Message();
  EXPECT_NE(message.find("changed.h5:/"), std::string::npos) << message;
  const bool free_text =
      field.path == "/@skeleton" || field.path == "/@created_by";  // checked only by the content hash
  const std::string named = free_text && std::strcmp(change_name, "a bit of") == 0 ? "/@content_sha256" : field.path;
  EXPECT_NE(message.find(named), std::string::npos) << kind.name << ", " << change_name << ": " << message;
}

template <class PerField>
void ForEveryField(const PerField& per_field) {
  const ScratchFolder folder;
  for (const Kind& kind : Kinds()) {
    const Status written = kind.write(folder / "good.h5");
    ASSERT_TRUE(written) << written.error().Message();
    const std::string bytes = ReadFile(folder / "good.h5").value();
    store::Content content;
    if (kind.schema == &store::DatasetSchema()) content.splits = {"by_person"};
    for (const Field& field : store::ConcreteFields(*kind.schema, content)) per_field(kind, bytes, field);
  }
}

TEST(StoreCorruption, AMissingFieldIsNamed) {
  ForEveryField([](const Kind& kind, const std::string& bytes, const Field& field) {
    if (field.presence == store::Presence::kOptional) return;
    ExpectRefused(kind, bytes, field, "missing", [&](hid_t file) { Remove(file, field); });
  });
}

TEST(StoreCorruption, AFileOfAnotherVersionHasTheVerbThatMakesItAgain) {
  EXPECT_TRUE(store::AreVersions("mocurate/0", "mocurate/1"));
  EXPECT_FALSE(store::AreVersions("mocurate/1", "mocurate/1"));
  EXPECT_FALSE(store::AreVersions("mocurate-evidence/0", "mocurate/1"));
  const ScratchFolder folder;
  for (const Kind& kind : Kinds()) {
    ASSERT_TRUE(kind.write(folder / "old.h5"));
    for (const Field& field : kind.schema->fields) {
      if (field.path.find("/frames/joints") == std::string::npos) continue;
      Change(folder / "old.h5", [&](hid_t file) { Remove(file, field); });
    }
    const Status read = kind.read(folder / "old.h5");
    ASSERT_FALSE(read) << kind.name;
    EXPECT_NE(read.error().hint.find("mocurate " + kind.schema->verb), std::string::npos) << read.error().Message();
  }
}

TEST(StoreCorruption, AMissingOptionalFieldIsReportedForTheClipsThatHaveIt) {
  ForEveryField([](const Kind& kind, const std::string& bytes, const Field& field) {
    if (field.presence != store::Presence::kOptional) return;
    Field missed = field;  // where the loss shows
    const bool rest = field.path == kind.schema->prefix + "/clips/rest_offset";
    missed.path = kind.schema->prefix + (rest ? "/frames/joints" : "/clips/field_mask");
    if (field.path.find("/fine_") != std::string::npos || field.path == "/about") missed.path = "/@content_sha256";
    ExpectRefused(kind, bytes, missed, "missing", [&](hid_t file) { Remove(file, field); });
  });
}

TEST(StoreCorruption, AFieldOfAnotherTypeIsNamed) {
  ForEveryField([](const Kind& kind, const std::string& bytes, const Field& field) {
    ExpectRefused(kind, bytes, field, "other type", [&](hid_t file) {
      const std::vector<hsize_t> shape = IsAttribute(field) ? std::vector<hsize_t>{} : ShapeOf(file, field);
      Replace(file, field, H5T_STD_I16LE, shape);
    });
  });
}

TEST(StoreCorruption, AFieldOfAnotherShapeIsNamed) {
  ForEveryField([](const Kind& kind, const std::string& bytes, const Field& field) {
    if (IsAttribute(field)) return;
    const auto change = [&](bool more_rows) {
      return [&field, more_rows](hid_t file) {
        const Hdf5Id dataset(H5Dopen2(file, field.path.c_str(), H5P_DEFAULT), H5Dclose);
        const Hdf5Id type(H5Dget_type(dataset.get()), H5Tclose);
        std::vector<hsize_t> shape = ShapeOf(file, field);
        if (more_rows) {
          shape[0] += 1;
        } else {
          shape.push_back(1);
        }
        Replace(file, field, type.get(), shape);
      };
    };
    ExpectRefused(kind, bytes, field, "one dimension more", change(false));
    if (!field.shape.empty() && field.shape[0] != "*") ExpectRefused(kind, bytes, field, "one row more", change(true));
  });
}

TEST(StoreCorruption, AFlippedBitIsNamed) {
  ForEveryField([](const Kind& kind, const std::string& bytes, const Field& field) {
    if (field.path == "/splits/by_person/validation") return;  // has no rows
    ExpectRefused(kind, bytes, field, "a bit of", [&](hid_t file) { FlipBit(file, field); });
  });
}

TEST(StoreCorruption, ALinkOutOfTheFileIsNotFollowed) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "good.h5"));
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "linked.h5"));
  Change(folder / "linked.h5", [&](hid_t file) {
    H5Ldelete(file, "/recipe", H5P_DEFAULT);
    H5Lcreate_external((folder / "good.h5").c_str(), "/recipe", file, "/recipe", H5P_DEFAULT, H5P_DEFAULT);
  });
  const auto read = ReadDataset(folder / "linked.h5");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().where.find("linked.h5:/recipe"), std::string::npos) << read.error().Message();
}

TEST(StoreCorruption, AFieldThatDeclaresMoreThanTheFileHoldsIsRefusedBeforeAllocation) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "huge.h5"));
  Change(folder / "huge.h5", [](hid_t file) {
    H5Ldelete(file, "/frames/joints", H5P_DEFAULT);
    const hsize_t shape[] = {1ull << 40, 6, 3};
    const Hdf5Id space(H5Screate_simple(3, shape, nullptr), H5Sclose);
    const Hdf5Id made(
        H5Dcreate2(file, "/frames/joints", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    ASSERT_TRUE(made.ok());
  });
  const auto read = ReadDataset(folder / "huge.h5");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
  EXPECT_NE(read.error().Message().find("huge.h5:/frames/joints: announces"), std::string::npos)
      << read.error().Message();
}

/// A dataset with one chunk of all its values, packed by deflate `times` times.
void Pack(hid_t file, const char* path, const std::vector<hsize_t>& shape, int times, const std::string& packed) {
  H5Ldelete(file, path, H5P_DEFAULT);
  const Hdf5Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.get(), static_cast<int>(shape.size()), shape.data());
  for (int i = 0; i < times; ++i) H5Pset_deflate(properties.get(), 9);
  const Hdf5Id made(H5Dcreate2(file, path, H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                    H5Dclose);
  ASSERT_TRUE(made.ok());
  const std::vector<hsize_t> first(shape.size(), 0);
  ASSERT_GE(H5Dwrite_chunk(made.get(), H5P_DEFAULT, 0, first.data(), packed.size(), packed.data()), 0);
}

/// A deflate stream of 1 MiB of zeros, without its end.
std::string PackedZeros() {
  std::string zeros(std::size_t{1} << 20, '\0'), packed(zeros.size(), '\0');
  z_stream stream{};
  deflateInit(&stream, 9);
  stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
  stream.avail_in = static_cast<uInt>(zeros.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FULL_FLUSH);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  return packed;
}

TEST(StoreCorruption, AChunkThatUnpacksToMoreThanItsDeclaredSizeIsRefused) {
  const ScratchFolder folder;
  const Field joints{"/frames/joints", {}, {}, {}, {}, {}, {}, {}};
  for (const int times : {1, 2}) {
    ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "packed.h5"));
    Change(folder / "packed.h5",
           [&](hid_t file) { Pack(file, "/frames/joints", ShapeOf(file, joints), times, PackedZeros()); });
    const auto read = ReadDataset(folder / "packed.h5");
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
    EXPECT_NE(read.error().where.find("packed.h5:/frames/joints"), std::string::npos) << read.error().Message();
  }
}

TEST(StoreCorruption, FieldsThatTogetherTakeMoreMemoryThanTheFileMayAreRefused) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "texts.h5"));
  Change(folder / "texts.h5", [](hid_t file) {
    const hsize_t count = 1'600'000;  // of one byte in the file
    const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose), type(H5Tcopy(H5T_C_S1), H5Tclose);
    const Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
    H5Ldelete(file, "/clips/label", H5P_DEFAULT);
    H5Ldelete(file, "/clips/view", H5P_DEFAULT);
    const Hdf5Id made(
        H5Dcreate2(file, "/clips/label", type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
        H5Dclose);
    ASSERT_TRUE(made.ok());
    ASSERT_GE(H5Lcreate_hard(file, "/clips/label", file, "/clips/view", H5P_DEFAULT, H5P_DEFAULT), 0);
  });
  const auto read = ReadDataset(folder / "texts.h5");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
  EXPECT_NE(read.error().where.find("texts.h5:/clips/label"), std::string::npos) << read.error().Message();
}

TEST(StoreCorruption, GroupsInsideEachOtherAreListedToALimit) {
  const ScratchFolder folder;
  for (const int depth : {50, 100}) {
    ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "deep.h5"));
    Change(folder / "deep.h5", [depth](hid_t file) {
      std::string path;
      for (int i = 0; i < depth; ++i) {
        path += "/g";
        const Hdf5Id made(H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
        ASSERT_TRUE(made.ok());
      }
      H5Lcreate_hard(file, "/g", file, (path + "/g").c_str(), H5P_DEFAULT, H5P_DEFAULT);  // a group inside itself
    });
    const auto described = DescribeStore(folder / "deep.h5");
    EXPECT_EQ(described.has_value(), depth == 50);
    EXPECT_TRUE(described || described.error().code == ErrorCode::kMalformed);
  }
}

TEST(StoreCorruption, ManyTextsOfAnyLengthMayNotBeOneLongText) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "long.h5"));
  Change(folder / "long.h5", [](hid_t file) {
    const hsize_t count = 100;
    const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose), type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), H5T_VARIABLE);
    const Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 1, &count);
    H5Ldelete(file, "/labels/name", H5P_DEFAULT);
    const Hdf5Id made(
        H5Dcreate2(file, "/labels/name", type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
        H5Dclose);
    const std::string text(1'000'000, 'a');
    std::vector<const char*> texts(count, "");
    texts[0] = text.c_str();
    ASSERT_GE(H5Dwrite(made.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), 0);
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    constexpr std::size_t kReference = 16;
    const hsize_t first = 0;
    std::uint32_t skipped = 0;
    std::vector<char> chunk(kReference * count);
    ASSERT_GE(H5Dread_chunk(made.get(), H5P_DEFAULT, &first, &skipped, chunk.data()), 0);
    for (std::size_t i = 1; i < count; ++i) std::copy_n(chunk.begin(), kReference, chunk.begin() + i * kReference);
    ASSERT_GE(H5Dwrite_chunk(made.get(), H5P_DEFAULT, 0, &first, chunk.size(), chunk.data()), 0);
  });
  const auto read = ReadDataset(folder / "long.h5");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
  EXPECT_NE(read.error().where.find("long.h5:/labels/name"), std::string::npos) << read.error().Message();
}

TEST(StoreCorruption, UnknownFieldsAreIgnored) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(test::MakeDataset(), folder / "more.h5"));
  Change(folder / "more.h5", [](hid_t file) {
    const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Id made(
        H5Dcreate2(file, "/frames/emg", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(made.ok());
  });
  EXPECT_TRUE(ReadDataset(folder / "more.h5"));
}

TEST(StoreCorruption, AFileOfAnotherSchemaIsRefusedWithItsSchema) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteEvidence(test::MakeEvidenceClip(false), folder / "evidence.h5"));
  const auto read = ReadDataset(folder / "evidence.h5");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().Message().find("the file is 'mocurate-evidence/1'; 'mocurate/1' was expected"),
            std::string::npos)
      << read.error().Message();
}

}  // namespace
}  // namespace mocurate
