// `mocurate rig audit` writes the rig of some takes as a file; other takes use it, and its content is part of their
// keys.

#include <gtest/gtest.h>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::FromCache;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;

/// Three takes before four cameras, the last of which was moved after its calibration, and a job about them.
class RigVerb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    studio_ = new ScratchFolder;
    const Result studio =
        RunProgram(*studio_, {"synthesize", "--layout", "openpose", "-o", (*studio_ / "studio").string(), "--set",
                              "subjects=1", "--set", "actions=[walk, throw, warm_up_bow_left]", "--set",
                              "rig.kind=ring", "--set", "rig.moved=0.12"});
    ASSERT_EQ(studio.exit_code, 0) << studio.err;
  }
  static void TearDownTestSuite() { delete studio_; }

  void SetUp() override {
    fs::create_directory_symlink(*studio_ / "studio", folder_ / "studio");
    WriteText(folder_ / "job.yaml",
              "include: sources/studio_keypoints.yaml\nname: moved\nskeleton: smpl24\n"
              "fitting: {method: keypoints, solver: banded}\n");
  }

  Result Audit(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"rig", "audit", (folder_ / "job.yaml").string(), "--set", Path(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(folder_, arguments);
  }

  /// Fits all takes with a rig.
  Result FitWith(const std::string& rig, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run",   (folder_ / "job.yaml").string(), "--to",  "fitting",
                                          "-o",    (folder_ / "r").string(),        "--set", Path(),
                                          "--set", "fitting.keypoints.rig=" + rig,  "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(folder_, arguments);
  }

  std::string Path() const { return "ingest.path=" + (folder_ / "studio/openpose").string(); }
  std::string File(const char* name) const { return (folder_ / name).string(); }

  static inline ScratchFolder* studio_ = nullptr;
  ScratchFolder folder_;
};

TEST_F(RigVerb, WritesAFileThatOtherTakesUse) {
  const Result audit = Audit({"--clip", "walk_p01_r01", "--clip", "throw_p01_r01", "-o", File("rig.yaml")});
  ASSERT_EQ(audit.exit_code, 0) << audit.err;
  const nlohmann::json answer = audit.Json();
  EXPECT_EQ(answer["takes"].size(), 2u);
  int corrected = 0;
  for (const auto& [name, camera] : answer["cameras"].items()) {
    if (camera["verdict"] == "kept") {
      EXPECT_TRUE(camera["confidence"].is_null()) << name;
      continue;
    }
    ++corrected;
    EXPECT_EQ(camera["verdict"], "corrected") << name;
    EXPECT_EQ(camera["confidence_of"], "takes") << name;
    EXPECT_NEAR(camera["moved_mm"].get<double>(), 120.0, 50.0);
  }
  EXPECT_EQ(corrected, 1);
  for (const auto& take : answer["takes"]) EXPECT_EQ(take["sha256"].get<std::string>().size(), 64u);

  const std::string text = ReadText(folder_ / "rig.yaml");
  ASSERT_EQ(Audit({"--clip", "walk_p01_r01", "--clip", "throw_p01_r01", "-o", File("again.yaml")}).exit_code, 0);
  EXPECT_EQ(ReadText(folder_ / "again.yaml"), text);

  const Result fit = FitWith(File("rig.yaml"));
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const nlohmann::json findings = fit.Json().value("findings", nlohmann::json::object());
  EXPECT_FALSE(findings.contains("camera_moved")) << findings;
  EXPECT_FALSE(findings.contains("rig_contradicted")) << findings;

  WriteText(folder_ / "config/rig.yaml", text);
  WriteText(folder_ / "config/job.yaml",
            "include: ../job.yaml\nfitting: {keypoints: {rig: rig.yaml}}\ningest: {path: ../studio/openpose}\n");
  const Result same = RunProgram(
      folder_, {"run", File("config/job.yaml"), "--to", "fitting", "-o", File("s"), "--json", "--allow-include"});
  ASSERT_EQ(same.exit_code, 0) << same.err;
  const int whole = FromCache(same.Json());
  EXPECT_GE(whole, 7) << "the same content in another file: three clips, their body and three fits";
  WriteText(folder_ / "config/rig.yaml", text + "# edited\n");
  const Result changed = RunProgram(
      folder_, {"run", File("config/job.yaml"), "--to", "fitting", "-o", File("s"), "--json", "--allow-include"});
  ASSERT_EQ(changed.exit_code, 0) << changed.err;
  EXPECT_LE(FromCache(changed.Json()), whole - 3) << "another content refits";
}

TEST_F(RigVerb, TakesAreNamedAsTheAuditNamesThem) {
  const Result all = Audit({"-o", File("rig.yaml"), "--set", "fitting.keypoints.rig=none.yaml"});
  ASSERT_EQ(all.exit_code, 0) << all.err << "the audit does not use a rig's file";
  for (const auto& take : all.Json()["takes"]) {
    const Result one = Audit({"-o", File("one.yaml"), "--force", "--clip", take["name"].get<std::string>()});
    ASSERT_EQ(one.exit_code, 0) << take["name"] << one.err;
    EXPECT_EQ(one.Json()["takes"].size(), 1u);
    EXPECT_EQ(one.Json()["takes"][0]["name"], take["name"]);
  }
}

TEST_F(RigVerb, OneTakeStatesRepeatability) {
  const Result audit = Audit({"--clip", "walk_p01_r01", "-o", File("rig.yaml")});
  ASSERT_EQ(audit.exit_code, 0) << audit.err;
  for (const auto& [name, camera] : audit.Json()["cameras"].items()) {
    EXPECT_EQ(camera["confidence_of"], "spans_of_one_take") << name;
  }
}

TEST_F(RigVerb, ABadFileIsRefusedBeforeAnyWork) {
  WriteText(folder_ / "version.yaml", "version: 7\ncameras: []\n");
  WriteText(folder_ / "text.yaml", "a walk\n");
  WriteText(folder_ / "empty.yaml", "");
  for (const char* name : {"version.yaml", "text.yaml", "empty.yaml", "none.yaml"}) {
    const Result refused = FitWith(File(name));
    EXPECT_EQ(refused.exit_code, 3) << name << refused.err;
    EXPECT_EQ(refused.Json()["error"]["code"], std::string(name) == "none.yaml" ? "not_found" : "malformed") << name;
    EXPECT_FALSE(fs::exists(folder_ / "r")) << name;
  }
}

TEST_F(RigVerb, AFileOfOtherCamerasIsRefused) {
  ASSERT_EQ(Audit({"--clip", "walk_p01_r01", "-o", File("rig.yaml")}).exit_code, 0);
  const std::string sound = ReadText(folder_ / "rig.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = sound;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    EXPECT_NE(text, sound) << from;
    WriteText(folder_ / "other.yaml", text);
    return FitWith(File("other.yaml"));
  };
  const std::size_t at = sound.find("- name: ", sound.find("\ncameras:")) + 8;
  const std::string camera = sound.substr(at, sound.find('\n', at) - at);
  EXPECT_NE(with("name: " + camera + "\n", "name: other\n").exit_code, 0);
  EXPECT_NE(with("width: ", "width: 1").exit_code, 0);
}

TEST_F(RigVerb, UsageErrorsAreExitCode2) {
  const std::vector<std::string> one = {"--clip", "walk_p01_r01", "-o", File("rig.yaml")};
  ASSERT_EQ(Audit(one).exit_code, 0);
  EXPECT_EQ(Audit(one).exit_code, 2) << "the file exists";
  EXPECT_EQ(Audit({"--clip", "walk_p01_r01", "-o", File("rig.yaml"), "--force"}).exit_code, 0);
  EXPECT_EQ(Audit({"-o", File("b.yaml"), "--clip", "jump"}).exit_code, 2);
  EXPECT_EQ(Audit({"-o", ""}).exit_code, 2);
  EXPECT_EQ(Audit({"-o", folder_.path().string(), "--force"}).exit_code, 2) << "a folder";
  EXPECT_EQ(Audit({"-o", File("no/folder/b.yaml")}).exit_code, 74);
  EXPECT_EQ(RunProgram(folder_, {"rig", "audit", "-o", File("b.yaml")}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder_, {"rig", "audit", "kard", "-o", File("b.yaml")}).exit_code, 2) << "joint tracks";
  EXPECT_EQ(RunProgram(folder_, {"rig", "audit", "rendered_seq", "-o", File("b.yaml")}).exit_code, 2) << "depth views";
  EXPECT_EQ(FitWith(File("rig.yaml"), {"--set", "fitting.method=none"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "b.yaml"));
}

}  // namespace
}  // namespace mocurate
