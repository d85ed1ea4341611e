// Compares the motion of the studio's people with recorded people: a Markdown table of speeds, jerk and joint ranges
// per class. Needs the unpacked data (MOCURATE_DATA). Usage: bench_studio_realism [SEED]

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <set>

#include "core/base/config.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "ingest/discover.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/studio_layouts.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30.0;
constexpr double kDegrees = 180.0 / 3.14159265358979323846;

/// One clip at 30 Hz: shoulder, elbow, wrist, hip, knee, ankle of both sides; missing frames are skipped.
struct Limbs {
  std::vector<std::array<Vector3d, 12>> frames;
};

struct Figures {
  std::vector<double> wrist_speed, ankle_speed, jerk, elbow, knee;
  int clips = 0;
};

/// Other names of the same joints: shoulder, elbow, wrist, hip, knee, ankle.
std::vector<std::string> Words(int part, const std::string& side) {
  static const std::vector<std::vector<std::string>> others = {{"shoulder", "upper_arm"}, {"elbow", "lower_arm"},
                                                               {"wrist", "hand"},         {"hip", "upper_leg"},
                                                               {"knee", "lower_leg"},     {"ankle", "foot"}};
  std::vector<std::string> words;
  for (const std::string& word : others[static_cast<std::size_t>(part)]) words.push_back(side + "_" + word);
  return words;
}

std::optional<Limbs> LimbsOf(const Clip& source) {
  const Clip clip = Resample(source, FrameRate{30, 1});
  Limbs limbs;
  const JointPositions& positions = clip.motion ? clip.motion->joints : clip.evidence.tracks->positions;
  std::array<int, 12> column{};
  for (int side = 0; side < 2; ++side) {
    for (int part = 0; part < 6; ++part) {
      int found = -1;
      for (const std::string& word : Words(part, side == 0 ? "left" : "right")) {
        if (found >= 0) break;
        if (clip.motion) {
          found = clip.motion->skeleton->FindJoint(word).value_or(-1);
        } else {
          const auto& names = clip.evidence.tracks->names;
          const auto at = std::find(names.begin(), names.end(), word);
          if (at != names.end()) found = static_cast<int>(at - names.begin());
        }
      }
      if (found < 0) return std::nullopt;
      column[static_cast<std::size_t>(6 * side + part)] = found;
    }
  }
  for (int f = 0; f < positions.frames; ++f) {
    std::array<Vector3d, 12> frame;
    for (std::size_t k = 0; k < 12; ++k) frame[k] = positions.at(f, column[k]);
    limbs.frames.push_back(frame);
  }
  return limbs;
}

double Flexion(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d upper = b - a, lower = c - b;
  return kDegrees * std::atan2(upper.cross(lower).norm(), upper.dot(lower));
}

void Add(const Limbs& limbs, Figures& figures) {
  ++figures.clips;
  const auto& frames = limbs.frames;
  for (std::size_t f = 1; f + 2 < frames.size(); ++f) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{6}}) {
      figures.wrist_speed.push_back((frames[f][side + 2] - frames[f - 1][side + 2]).norm() * kRateHz);
      figures.ankle_speed.push_back((frames[f][side + 5] - frames[f - 1][side + 5]).norm() * kRateHz);
      const Vector3d third =
          frames[f + 2][side + 2] - 3.0 * frames[f + 1][side + 2] + 3.0 * frames[f][side + 2] - frames[f - 1][side + 2];
      figures.jerk.push_back(third.norm() * kRateHz * kRateHz * kRateHz);
      figures.elbow.push_back(Flexion(frames[f][side], frames[f][side + 1], frames[f][side + 2]));
      figures.knee.push_back(Flexion(frames[f][side + 3], frames[f][side + 4], frames[f][side + 5]));
    }
  }
}

double At(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void Print(const std::string& name, const std::string& set, const Figures& f) {
  std::printf("| %s | %s | %d | %.2f | %.1f | %.1f | %.0f | %.0f-%.0f | %.0f-%.0f |\n", name.c_str(), set.c_str(),
              f.clips, At(f.wrist_speed, 0.5), At(f.wrist_speed, 0.95), At(f.ankle_speed, 0.95), At(f.jerk, 0.5),
              At(f.elbow, 0.05), At(f.elbow, 0.95), At(f.knee, 0.05), At(f.knee, 0.95));
}

/// Figures of the wanted labels, of at most 24 clips each that a declaration of configs/sources finds. `changes`
/// override the declaration as `--set` does.
std::map<std::string, Figures> Measured(const std::string& declaration, std::vector<std::string> assignments,
                                        const fs::path& scratch, const std::set<std::string>& wanted) {
  constexpr int most = 24;
  std::map<std::string, Figures> figures;
  const auto node = LoadConfig(fs::path(MOCURATE_SOURCE_FOLDER) / "configs/sources" / (declaration + ".yaml"),
                               std::move(assignments));
  if (!node) return std::fprintf(stderr, "%s\n", node.error().Message().c_str()), figures;
  const auto options = OptionsFromConfig<IngestOptions>(*node->Find("ingest"));
  const auto discovery = options ? Discover(*options) : Expected<Discovery>(tl::unexpected<Error>(options.error()));
  if (!discovery) return std::fprintf(stderr, "%s\n", discovery.error().Message().c_str()), figures;
  for (const ItemSpec& item : discovery->items) {
    const auto named = ReadName(options->source, item.inputs.at(0).name);
    if (!named || wanted.count(named->label) == 0 || figures[named->label].clips >= most) continue;
    const StageRequest request{"ingest", item.item, item.options.Whole(), item.inputs, scratch / "clip.h5", scratch};
    if (const auto outcome = IngestStage(request); !outcome) continue;
    const auto clip = ReadEvidence(request.output);
    if (!clip) continue;
    if (const auto limbs = LimbsOf(*clip)) Add(*limbs, figures[clip->label]);
  }
  return figures;
}

/// The studio's own actions, without any sensor: six people, twice each.
Figures Performed(const std::string& action, std::int64_t seed) {
  StudioOptions options;
  options.seed = seed;
  options.subjects = 6;
  options.clips = 2;
  const std::vector<SetClass> classes = {{1, action.c_str(), action.c_str(), 0.0}};
  const auto actors = ActorsOf(options, 6, nullptr);
  const auto takes = PlanTakes(options, classes, {6, 2, kRateHz, 0.0, 0.1});
  Figures figures;
  if (!actors || !takes) return figures;
  for (const PlannedTake& take : *takes) {
    const Actor& actor = (*actors)[static_cast<std::size_t>(take.subject - 1)];
    Clip clip;
    clip.motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{30, 1});
    clip.rate = clip.motion->rate;
    if (const auto limbs = LimbsOf(clip)) Add(*limbs, figures);
  }
  return figures;
}

/// An action of the studio and its labels in other sets; empty: the set does not have it.
struct Row {
  const char* action;
  const char* bandai1;
  const char* bandai2;
  const char* hdm05;
};

constexpr Row kRows[] = {{"walk", "walk", "walk", ""},
                         {"run", "run", "run", "jogLeftCircle4StepsRstart"},
                         {"kick", "kick", "", "kickLFront1Reps"},
                         {"boxing_right_left", "punch", "", ""},
                         {"wave", "", "wave-right-hand", ""},
                         {"warm_up_bow_right", "bow", "", ""},
                         {"squat", "", "", "squat1Reps"},
                         {"throw_both_hands", "", "", "throwBasketball"},
                         {"jump_vertical", "", "", "hopBothLegs1hops"}};

std::set<std::string> LabelsOf(const char* Row::*set) {
  std::set<std::string> labels;
  for (const Row& row : kRows) labels.insert(row.*set);
  return labels;
}

/// Activities of KARD that the studio tracks.
constexpr const char* kTracked[] = {"walk",       "high_arm_wave", "two_hand_wave", "hand_clap",
                                    "high_throw", "forward_kick",  "side_kick",     "bend",
                                    "drink",      "phone_call",    "sit_down",      "stand_up"};

int Run(std::int64_t seed) {
  const char* unpacked = std::getenv("MOCURATE_DATA");
  if (unpacked == nullptr) return std::fprintf(stderr, "MOCURATE_DATA is not set\n"), 1;
  const std::string data = unpacked;
  const fs::path scratch = fs::temp_directory_path() / ("studio_realism_" + std::to_string(getpid()));
  fs::create_directories(scratch);
  auto bandai1 = Measured(
      "bandai2",
      {"ingest.path=" + data + "/bvh/bandai1", "ingest.source.files=\"dataset-1_{action}_{style}_{repetition}.bvh\""},
      scratch, LabelsOf(&Row::bandai1));
  auto bandai2 = Measured("bandai2", {"ingest.path=" + data + "/bvh/bandai2"}, scratch, LabelsOf(&Row::bandai2));
  auto hdm05 = Measured("hdm05", {"ingest.path=" + data + "/hdm05"}, scratch, LabelsOf(&Row::hdm05));
  const char* head =
      "| class | set | clips | wrist speed median, m/s | 95 % | ankle speed 95 % | wrist jerk median, m/s3 | elbow, "
      "degrees 5-95 % | knee |\n|---|---|---|---|---|---|---|---|---|\n";
  std::fputs(head, stdout);
  for (const Row& row : kRows) {
    Print(row.action, "studio", Performed(row.action, seed));
    if (row.bandai1[0] != '\0') Print(row.bandai1, "Bandai 1", bandai1[row.bandai1]);
    if (row.bandai2[0] != '\0') Print(row.bandai2, "Bandai 2", bandai2[row.bandai2]);
    if (row.hdm05[0] != '\0') Print(row.hdm05, "HDM05", hdm05[row.hdm05]);
  }

  StudioOptions options;
  options.layout = StudioLayout::kKard;
  options.seed = seed;
  options.subjects = 6;
  options.clips = 2;
  const auto written = WriteStudioLayout(options, scratch / "studio", 2);
  if (!written) return std::fprintf(stderr, "%s\n", written.error().Message().c_str()), 1;
  auto tracked = Measured("kard", {"ingest.path=" + (scratch / "studio/kard").string()}, scratch,
                          {std::begin(kTracked), std::end(kTracked)});
  auto kard =
      Measured("kard", {"ingest.path=" + data + "/kinect/kard"}, scratch, {std::begin(kTracked), std::end(kTracked)});
  std::fputs("\n", stdout);
  std::fputs(head, stdout);
  for (const char* label : kTracked) {
    Print(label, "studio, tracked", tracked[label]);
    Print(label, "KARD", kard[label]);
  }
  fs::remove_all(scratch);
  return 0;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) { return mocurate::Run(argc > 1 ? std::atoll(argv[1]) : 1); }
