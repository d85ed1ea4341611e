// Pickles that name more than plain data never run; they are errors of their file, alone and in an archive.

#include "core/formats/zip_archive.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAreArray;
using Json = nlohmann::json;

const std::string kHostile = "cos\nsystem\n(S'true'\ntR.";

class UnsafePickles : public WrittenFormats {
 protected:
  /// Places of the "unsafe_pickle" errors; each error names the callable of the pickle.
  static std::vector<std::string> Refused(const std::filesystem::path& path) {
    std::vector<std::string> places;
    for (const Json& finding : FindingsOf(InspectPath(path, std::nullopt), "unsafe_pickle")) {
      EXPECT_EQ(finding.at("severity"), "error");
      EXPECT_THAT(finding.at("message"), HasSubstr("'os system'"));
      places.push_back(finding.at("where"));
    }
    return places;
  }
};

TEST_F(UnsafePickles, AreReportedAsErrorsAloneAndInArchives) {
  const std::string archive = WriteStoredZip({{"archive/data.pkl", kHostile}, {"archive/version", "3"}}, "z").value();
  Written("notes.txt", "of no format");
  Written("tracks.pkl", kHostile);
  std::vector<std::string> places = {"tracks.pkl: byte 11"};
  for (const std::string name : {"weights.pt", "tracks.zip", "clip.npz"}) {
    places.push_back(name + ":archive/data.pkl: byte 11");
    EXPECT_THAT(Refused(Written(name, archive)), ElementsAre(places.back()));
  }
  EXPECT_THAT(Refused(folder_), UnorderedElementsAreArray(places));
  const IngestOptions options = Declared("humanact12_npy", {"ingest.path=" + folder_.string()});
  Written("P01G01R01F0001T0064A0101.npy", archive);
  const Status refused = IngestOnly(options, "hostile_archive");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().reason, Reason::kUnsafePickle);
  EXPECT_EQ(refused.error().where, "P01G01R01F0001T0064A0101.npy:archive/data.pkl: byte 11");
}

/// The unsafe member is skipped, the motion is read.
TEST_F(UnsafePickles, AreReportedAsWarningsBesideAMotion) {
  StudioOptions studio;
  studio.layout = StudioLayout::kAmass;
  ASSERT_TRUE(WriteStudioLayout(studio, folder_ / "written", 1));
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "written/amass"))
    if (entry.path().extension() == ".npz") file = entry.path();
  const std::string bytes = *ReadFile(file);
  ZipArchive archive = *ZipArchive::Open(bytes, "a");
  std::vector<std::pair<std::string, std::string>> members = {{"extra.pkl", kHostile}};
  for (std::size_t i = 0; i < archive.members().size(); ++i)
    members.emplace_back(archive.members()[i], *archive.Read(i));
  const Json inspection = InspectPath(Written("walk.npz", *WriteStoredZip(members, "z")), std::nullopt);
  EXPECT_EQ(inspection.at("clips").size(), 1u);
  EXPECT_THAT(Places(inspection, "warning"), ElementsAre("unsafe_pickle walk.npz"));
  EXPECT_THAT(FindingsOf(inspection, "unsafe_pickle")[0].at("message"), HasSubstr("walk.npz:extra.pkl"));
}

}  // namespace
}  // namespace mocurate
