// One answer about a file: what an inspection says without a declaration, and what a run reads by the declaration that
// it proposes.

#include <gmock/gmock.h>

#include <set>

#include "core/base/config.h"
#include "core/base/text.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/read_motions.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The source that an inspection proposes; what it leaves open is filled in with any value.
SourceOptions Proposed(const fs::path& path, const fs::path& scratch, IngestOptions& options) {
  const auto written = DeclareSource(InspectPath(path, std::nullopt), path, "mine");
  if (!written) {
    ADD_FAILURE() << written.error().Message();
    return {};
  }
  std::string yaml;
  for (const std::string_view line : SplitText(written->yaml, '\n')) {
    std::string text(line);
    const std::size_t open = text.find("\"FILL_IN");
    const auto is = [&](const char* option) { return Trim(text).rfind(option, 0) == 0; };
    if (open != std::string::npos && !is("#")) text.erase(open);
    if (open != std::string::npos && !is("#")) {
      text += is("rate:") ? "30 Hz" : is("units:") ? "m" : is("axes:") ? "\"+x +y +z\"" : "\"\"";
    }
    for (std::size_t at = 0; (at = text.find("FILL_IN")) != std::string::npos && !is("#");) text.replace(at, 7, "skip");
    yaml += text + "\n";
  }
  Put(scratch / "proposed.yaml", yaml);
  const auto node = LoadConfig(scratch / "proposed.yaml", {});
  const ConfigNode* group = node ? node->Find("ingest") : nullptr;
  const auto read = group != nullptr ? OptionsFromConfig<IngestOptions>(*group)
                                     : Expected<IngestOptions>(tl::unexpected<Error>(Error()));
  if (!read) {
    ADD_FAILURE() << (node ? read.error().Message() : node.error().Message()) << yaml;
    return {};
  }
  options = *read;
  return read->source;
}

/// Errors about the file; what is declared for the test may be wrong.
std::multiset<std::string> Faults(const Json& inspection) {
  std::multiset<std::string> faults;
  for (const Json& finding : inspection.at("findings")) {
    const std::string code = finding.at("code");
    const bool declared = EndsWith(code, "_contradiction") || code == "rate_suspect" || code == "rate_implausible";
    if (finding.at("severity") == "error" && !declared) faults.insert(code);
  }
  return faults;
}

class OneReader : public RecordedFormats, public ::testing::WithParamInterface<const char*> {};

TEST_P(OneReader, InspectionAndRunReadTheSame) {
  const ScratchFolder scratch;
  const fs::path file = fs::path(TestData()) / GetParam();
  IngestOptions options;
  const SourceOptions source = Proposed(file, scratch / "", options);
  ASSERT_FALSE(source.format.empty());
  const Json undeclared = InspectPath(file, std::nullopt), declared = InspectPath(file, source);
  ASSERT_EQ(undeclared.at("clips").size(), declared.at("clips").size()) << declared.at("findings").dump(1);
  for (std::size_t c = 0; c < undeclared.at("clips").size(); ++c) {
    const Json &one = undeclared.at("clips")[c], &other = declared.at("clips")[c];
    EXPECT_EQ(Value(one, "frames"), Value(other, "frames"));
    if (one.at("format") != "amass") {  // whose 52 joints are read on the skeleton's 24
      EXPECT_EQ(Value(one, "joints"), Value(other, "joints"));
    }
    EXPECT_EQ(Value(one, "people"), Value(other, "people"));
  }
  EXPECT_EQ(Faults(undeclared), Faults(declared));
  options.path = file;
  const auto read = ReadAllMotions({options, {}});
  ASSERT_TRUE(read) << read.error().Message();
  ASSERT_EQ(read->set.clips.size() + read->refused.size(), declared.at("clips").size());
  if (declared.at("clips").size() == 1) {
    EXPECT_EQ(read->set.clips.at(0).motion->frame_count(), Value(declared.at("clips")[0], "frames"));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, OneReader,
                         ::testing::Values("kinect/kard/a09_s01_e01_realworld.txt",
                                           "kinect/msr_action3d/a06_s01_e01_skeleton3D.txt",
                                           "kinect/utkinect/walk_s01_e01.txt", "kinect/florence3d/a01_s1_id1.txt",
                                           "kinect/cad60/0512165327.txt", "ntu/S001C001P001R001A011.skeleton",
                                           "amass_babel/amass_sample.npz", "bvh/bandai1/dataset-1_bow_active_001.bvh",
                                           "bvh/misc/chenzunh23_walk_noitom_yxz.bvh", "cmu/asf_amc/01_01.bvh"));

}  // namespace
}  // namespace mocurate
