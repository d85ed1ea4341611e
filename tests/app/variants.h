#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/store/store.h"
#include "tests/app/program.h"

/// What the program made of a small set, judged by exit code, numbers and codes.
namespace mocurate::variants {

struct Verdict {
  int exit_code = -1;
  std::set<std::string> codes;  ///< of findings, rules and reasons, in the curation log and in the JSON document
  std::vector<nlohmann::json> log;
  std::optional<Dataset> dataset;
  std::string text;  ///< for messages

  bool Has(const std::string& code) const { return codes.count(code) != 0; }
  std::size_t Decided(const std::string& decision) const {
    std::size_t count = 0;
    for (const nlohmann::json& clip : log) count += clip.value("decision", std::string()) == decision ? 1 : 0;
    return count;
  }
};

inline void CollectCodes(const nlohmann::json& value, std::set<std::string>& codes) {
  if (!value.is_structured()) return;
  for (const nlohmann::json& inner : value) CollectCodes(inner, codes);
  if (!value.is_object()) return;
  for (const char* key : {"code", "rule", "reason"}) {
    const auto at = value.find(key);
    if (at != value.end() && at->is_string()) codes.insert(at->get<std::string>());
  }
}

/// Runs a job up to the stage `to`.
inline Verdict RunJob(const ScratchFolder& folder, const std::string& job, const std::string& to = "assemble") {
  program::WriteText(folder / "job.yaml", job);
  const program::Result result =
      program::RunProgram(folder, {"run", (folder / "job.yaml").string(), "-o", (folder / "r").string(), "--to", to,
                                   "--json", "--jobs", "1", "--set", "fitting.solver=banded"});
  Verdict verdict;
  verdict.exit_code = result.exit_code;
  CollectCodes(nlohmann::json::parse(result.out, nullptr, false), verdict.codes);
  std::ifstream log(folder / "r/curation_log.jsonl");
  for (std::string line; std::getline(log, line);) {
    verdict.log.push_back(nlohmann::json::parse(line, nullptr, false));
    CollectCodes(verdict.log.back(), verdict.codes);
    verdict.text += line.substr(0, 3000) + "\n";
  }
  verdict.text += result.err.substr(0, 3000);
  if (std::filesystem::exists(folder / "r/dataset.h5")) {
    auto dataset = ReadDataset(folder / "r/dataset.h5");
    EXPECT_TRUE(dataset) << dataset.error().Message();
    if (dataset) verdict.dataset = std::move(*dataset);
  }
  return verdict;
}

/// Frames [begin, end) of the dataset's clip.
struct Frames {
  int begin = 0;
  int end = 0;
};

inline JointState StateAt(const Motion& motion, int frame, int joint) {
  if (motion.state.empty()) return JointState::kObserved;
  return motion.state[static_cast<std::size_t>(frame) * static_cast<std::size_t>(motion.joint_count()) +
                      static_cast<std::size_t>(joint)];
}

/// Joints of the span whose state is one of these.
inline int CountStates(const Motion& motion, Frames span, const std::set<JointState>& states) {
  int count = 0;
  for (int f = span.begin; f < span.end; ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) count += static_cast<int>(states.count(StateAt(motion, f, j)));
  }
  return count;
}

/// How a variant has to end: one kept clip, or none with its reason.
struct Ending {
  enum class End { kKept, kRefused, kExcluded } end = End::kKept;
  int frames = 0;  ///< of the kept clip
  std::optional<Frames>
      interpolated;                   ///< of the kept clip: no joint is observed there, none is a guess over a long gap
  std::optional<Frames> inferred;     ///< of the kept clip: every joint has this state there
  std::vector<std::string> codes;     ///< findings that must be there
  std::vector<std::string> no_codes;  ///< findings that must not
};

inline void ExpectKept(const Verdict& verdict, const Ending& expected) {
  EXPECT_EQ(verdict.exit_code, 0) << verdict.text;
  ASSERT_TRUE(verdict.dataset) << verdict.text;
  ASSERT_EQ(verdict.dataset->clips.size(), 1u) << verdict.text;
  const Motion& motion = *verdict.dataset->clips[0].motion;
  ASSERT_EQ(motion.frame_count(), expected.frames) << verdict.text;
  const int joints = motion.joint_count();
  Frames gap{expected.frames, expected.frames};
  if (expected.interpolated) {
    gap = *expected.interpolated;
    EXPECT_EQ(CountStates(motion, gap, {JointState::kObserved, JointState::kRepaired}), 0)
        << "observed joints of " << (gap.end - gap.begin) * joints << " without an observation\n"
        << verdict.text;
    EXPECT_GT(CountStates(motion, gap, {JointState::kInterpolated}), 0) << "interpolated joints\n" << verdict.text;
  }
  if (expected.inferred) {
    gap = *expected.inferred;
    EXPECT_EQ(CountStates(motion, gap, {JointState::kInferred}), (gap.end - gap.begin) * joints) << "inferred joints\n"
                                                                                                 << verdict.text;
  }
  for (int f = 0; f < expected.frames; ++f) {
    if (f >= gap.begin && f < gap.end) continue;
    ASSERT_GT(CountStates(motion, {f, f + 1}, {JointState::kObserved, JointState::kRepaired}), 0)
        << "observed joints of frame " << f << ", in which the person is seen";
  }
}

/// None wrong: a set that is not kept as expected ends with its reason, not with another clip.
inline void Judge(const Verdict& verdict, const Ending& expected) {
  for (const std::string& code : expected.codes) EXPECT_TRUE(verdict.Has(code)) << code << "\n" << verdict.text;
  for (const std::string& code : expected.no_codes) EXPECT_FALSE(verdict.Has(code)) << code << "\n" << verdict.text;
  if (expected.end == Ending::End::kKept) return ExpectKept(verdict, expected);
  EXPECT_EQ(verdict.Decided("kept"), 0u) << verdict.text;
  EXPECT_NE(verdict.exit_code, 0) << verdict.text;
  EXPECT_FALSE(verdict.dataset) << verdict.text;
  if (expected.end == Ending::End::kExcluded) {
    EXPECT_EQ(verdict.Decided("excluded"), 1u) << verdict.text;
  }
}

}  // namespace mocurate::variants
