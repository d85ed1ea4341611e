#include "ingest/sources/array_clips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/mdm_results.h"
#include "core/formats/npz.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/sources/mapped_file.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

constexpr std::size_t kArrayHead = 1 << 16;
constexpr std::size_t kFewestJoints = 3;
constexpr int kDigits = 4;

bool IsNumber(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// "[walk][3]" as "walk" and "3". A member's name may contain brackets: only a number in them is the entry.
std::vector<std::string> PartsOf(const std::string& id) {
  if (id.size() < 2 || id.front() != '[' || id.back() != ']') return {};
  const std::size_t between = id.rfind("][");
  if (between != std::string::npos) {
    const std::string entry = id.substr(between + 2, id.size() - between - 3);
    if (IsNumber(entry)) return {id.substr(1, between - 1), entry};
  }
  return {id.substr(1, id.size() - 2)};
}

void AddClips(const std::vector<std::size_t>& shape, const std::string& member, std::vector<ArrayClip>& clips) {
  const std::optional<ArrayShape> joints = ShapeOfJoints(shape);
  if (!joints) return;
  for (std::size_t i = 0; i < joints->clips; ++i) {
    const std::string label = joints->classes > 0 ? std::to_string(i % joints->classes) : "";
    clips.push_back({member + (joints->batch ? "[" + std::to_string(i) + "]" : ""), joints->joints, label});
  }
}

/// Whether a file of that many bytes can contain arrays of the shape: a number takes at least one byte.
bool HoldsArrays(const std::vector<std::size_t>& shape, std::uintmax_t bytes) {
  const std::optional<ArrayShape> joints = ShapeOfJoints(shape);
  return joints && joints->clips <= bytes / joints->frames / (3 * joints->joints);
}

/// The clips of a batch lie along the first axis.
Expected<NpyArray> EntryOf(NpyArray array, std::size_t entry, const std::string& name) {
  if (array.shape.empty() || entry >= array.shape[0]) {
    return Fail(ErrorCode::kInconsistent, "clip " + std::to_string(entry) + " does not exist", name);
  }
  const auto each = static_cast<std::ptrdiff_t>(array.values.size() / array.shape[0]);
  array.values = {array.values.begin() + each * static_cast<std::ptrdiff_t>(entry),
                  array.values.begin() + each * static_cast<std::ptrdiff_t>(entry + 1)};
  array.shape.erase(array.shape.begin());
  return array;
}

constexpr std::size_t kFewestArrayFrames = 8;  // fewer tell no spread of lengths
constexpr std::size_t kFewestArrayJoints = 10, kMostArrayJoints = 200;
constexpr double kClearlyRigid = 0.5 * kRigid;

/// Axes of the array that are frames, joints and coordinates.
using Axes = std::array<std::size_t, 3>;
constexpr Axes kAsItLies = {0, 1, 2};
constexpr Axes kExchanged[] = {{1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}};

bool Possible(const NpyArray& array, const Axes& axes) {
  const std::size_t frames = array.shape[axes[0]], joints = array.shape[axes[1]];
  return array.shape[axes[2]] == 3 && frames >= kFewestArrayFrames && joints >= kFewestArrayJoints &&
         joints <= kMostArrayJoints;
}

struct Points {
  JointPositions positions;
  std::vector<double> confidence;
};

Points ReadPoints(const NpyArray& array, const Axes& axes) {
  const std::array<std::size_t, 3> stride = {array.shape[1] * array.shape[2], array.shape[2], 1};
  const auto frames = static_cast<int>(array.shape[axes[0]]), joints = static_cast<int>(array.shape[axes[1]]);
  Points points{JointPositions(frames, joints), {}};
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      Vector3d at;
      for (int c = 0; c < 3; ++c) {
        at[c] =
            array.values[static_cast<std::size_t>(f) * stride[axes[0]] + static_cast<std::size_t>(j) * stride[axes[1]] +
                         static_cast<std::size_t>(c) * stride[axes[2]]];
      }
      const bool seen = at.allFinite() && at.cwiseAbs().maxCoeff() <= kLargestNumber;
      points.confidence.push_back(seen ? 1.0 : 0.0);
      if (seen) points.positions.at(f, j) = at;
    }
  }
  return points;
}

/// The known order in which they are a body; nothing where there is none.
std::optional<std::string> BodyIn(const Points& points) {
  const std::vector<OrderScore> scores = ScoreOrders(points.positions, points.confidence);
  if (scores.empty() || !scores[0].score.IsBody()) return std::nullopt;
  return scores[0].order->name;
}

/// Whether two of SMPL's joints without its root, the feet, are 0 0 0 throughout, as fits to captures leave them.
bool FeetNeverTurn(const JointPositions& vectors) {
  for (const int foot : {9, 10}) {
    for (int f = 0; f < vectors.frames; ++f) {
      if (!Vector3d(vectors.at(f, foot)).isZero(0.0)) return false;
    }
  }
  return true;
}

std::string ShapeOfAxes(const Axes& axes) {
  std::array<std::string, 3> names;
  names[axes[0]] = "frames";
  names[axes[1]] = "joints";
  names[axes[2]] = "3";
  return "(" + names[0] + ", " + names[1] + ", " + names[2] + ")";
}

}  // namespace

std::optional<ExportedMotion> ExportedMotionIn(const Npz& npz) {
  const NpyArray* joints = npz.Find("joints");
  const NpyArray* names = npz.Find("joint_names");
  const NpyArray* parents = npz.Find("parents");
  const NpyArray* rate = npz.Find("mocap_frame_rate");
  const NpyArray* skeleton = npz.Find("skeleton");
  for (const NpyArray* array : {joints, names, parents, rate, skeleton, npz.Find("representation")}) {
    if (array == nullptr) return std::nullopt;
  }
  const std::size_t count = names->texts.size();
  const bool places = joints->shape.size() == 3 && joints->shape[1] == count && joints->shape[2] == 3;
  if (!places || joints->values.empty() || parents->values.size() != count) return std::nullopt;
  if (skeleton->texts.size() != 1 || rate->values.size() != 1) return std::nullopt;
  ExportedMotion exported{joints, names->texts, {}, skeleton->texts[0], rate->values[0]};
  if (!std::isfinite(exported.rate_hz) || exported.rate_hz <= 0.0) return std::nullopt;
  for (std::size_t j = 0; j < count; ++j) {
    const double parent = parents->values[j];
    // A parent comes before its children, as in every skeleton.
    if (!(parent >= -1.0 && parent < static_cast<double>(j)) || (j > 0) != (parent >= 0.0)) return std::nullopt;
    exported.parents.push_back(static_cast<int>(parent));
  }
  const NpyArray* state = npz.Find("state");
  const bool states = state != nullptr && state->shape == std::vector<std::size_t>{joints->shape[0], count} &&
                      std::all_of(state->values.begin(), state->values.end(), [](double value) {
                        return value == 0.0 || value == 1.0 || value == 2.0 || value == 3.0;
                      });
  if (states) exported.state = state;
  return exported;
}

bool IsArrayOfObjects(const NpyArray& header) { return header.dtype == "|O"; }

bool ArePeople(const std::vector<std::size_t>& shape) {
  constexpr std::size_t kMostPeople = 2;
  return shape.size() == 4 && shape[3] == 3 && shape[1] <= kMostPeople && shape[0] >= kFewestArrayFrames;
}

std::optional<ArrayShape> ShapeOfJoints(const std::vector<std::size_t>& shape) {
  std::vector<std::size_t> sizes = shape;
  const bool of_classes = sizes.size() == 5;
  if ((sizes.size() == 4 || of_classes) && sizes[sizes.size() - 2] == 3 && sizes.back() != 3) {
    const std::size_t joints = sizes[sizes.size() - 3];
    if (joints < kFewestJoints || std::count(sizes.begin(), sizes.end(), std::size_t{0}) != 0) return std::nullopt;
    const std::size_t classes = of_classes ? sizes[1] : 0;
    if (of_classes && sizes[0] > SIZE_MAX / classes) return std::nullopt;
    return ArrayShape{true, true, sizes[0] * std::max<std::size_t>(1, classes), classes, sizes.back(), joints};
  }
  // Coordinates in the middle: (frames, 3, joints) is not a batch of clips of three frames.
  if (sizes.size() == 3 && sizes[1] == 3 && sizes[2] != 3) return std::nullopt;
  if (sizes.size() >= 3 && sizes.back() == 3) {
    sizes.pop_back();
    if (sizes.back() > SIZE_MAX / 3) return std::nullopt;
    sizes.back() *= 3;
  }
  const bool batch = sizes.size() == 3;
  if (sizes.size() != 2 && !batch) return std::nullopt;
  if (sizes.back() % 3 != 0 || sizes.back() / 3 < kFewestJoints) return std::nullopt;
  if (std::count(sizes.begin(), sizes.end(), std::size_t{0}) != 0) return std::nullopt;
  if (ArePeople(shape)) return std::nullopt;
  return ArrayShape{batch, false, batch ? sizes[0] : 1, 0, sizes[sizes.size() - 2], sizes.back() / 3};
}

std::string OtherThanJoints(const std::vector<std::size_t>& shape) {
  if (ArePeople(shape))
    return "(frames, people, joints, 3): write a file for each person, as numpy's array[:, 0] gives the first";
  if (shape.size() < 2 || (shape.back() != 263 && shape.back() != 251)) return "";
  return std::string("features of ") + (shape.back() == 263 ? "HumanML3D" : "KIT-ML") +
         " (root velocities, positions, rotations and contacts of a frame), not joint positions: use the joints that "
         "they "
         "were made from (new_joints/), or recover them with the set's recover_from_ric";
}

bool IsBodyParameter(std::string_view name) {
  constexpr std::string_view kNames[] = {
      "body_pose",  "global_orient", "transl",      "betas",     "left_hand_pose", "right_hand_pose", "jaw_pose",
      "leye_pose",  "reye_pose",     "expression",  "smpl_pose", "smpl_poses",     "smpl_trans",      "smpl_thetas",
      "smpl_betas", "thetas",        "root_orient", "pose_body", "pose_hand",      "fullpose"};
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

std::string RotationsInstead(const NpyArray& array, const std::string& name, const std::vector<RawBone>& declared) {
  constexpr std::pair<std::size_t, const char*> kColumns[] = {
      {63, "SMPL-H's body"}, {66, "SMPL's body"}, {69, "SMPL's body"}, {72, "SMPL"}, {156, "SMPL-H"}, {165, "SMPL-X"}};
  constexpr int kBody = 22;           // joints that all of them begin with
  constexpr double kHalfTurn = 3.15;  // radians
  const std::string way =
      ", not joint positions: write them as AMASS does, `poses`, `trans`, `betas`, `gender` and "
      "`mocap_framerate` in one .npz, which is read with its rotations";
  const std::string stem = std::filesystem::path(name).stem().string();
  if (IsBodyParameter(stem)) return "'" + stem + "' of a program of SMPL" + way;
  const bool zero = std::all_of(array.values.begin(), array.values.end(), [](double value) { return value == 0.0; });
  const bool frames = array.shape.size() == 2 && !zero && array.shape[0] >= kFewestArrayFrames;
  const std::size_t wide = frames ? array.shape[1] : 0;
  const auto* of = std::find_if(std::begin(kColumns), std::end(kColumns),
                                [&](const auto& columns) { return wide == columns.first; });
  if (of == std::end(kColumns)) return "";
  for (std::size_t at = 0; at + 2 < array.values.size(); at += 3) {
    if (!(std::hypot(array.values[at], array.values[at + 1], array.values[at + 2]) <= kHalfTurn)) return "";
  }
  const Points points = ReadPoints({{array.shape[0], wide / 3, 3}, array.dtype, array.values, {}}, kAsItLies);
  // Other skeletons have as many joints as SMPL without its root.
  if ((wide == 63 || wide == 69) && !FeetNeverTurn(points.positions)) return "";
  const Expected<SkeletonPtr> smpl = KnownSkeleton("smpl24");
  const std::vector<std::string> body(kSmplJointNames, kSmplJointNames + kBody);
  if (!declared.empty() && ScoreBody(points.positions, points.confidence, declared).IsBody()) return "";
  if (BodyIn(points) || !smpl || ScoreBody(points.positions, points.confidence, BonesOf(body, **smpl)).IsBody())
    return "";
  return "as many numbers a frame as the rotation vectors of " + std::string(of->second) +
         ", none longer than half a turn, which are no body" + way;
}

std::vector<ArrayClip> ArrayClipsOf(const std::filesystem::path& path, const std::string& name) {
  std::ifstream file(path, std::ios::binary);
  std::string head(kArrayHead, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  std::vector<ArrayClip> clips;
  if (KindOf(head) == FileKind::kNpy) {
    const Expected<NpyArray> array = ParseNpyHeader(head, name);
    std::error_code unknown;
    const std::uintmax_t bytes = std::filesystem::file_size(path, unknown);
    if (array && !unknown && HoldsArrays(array->shape, bytes)) AddClips(array->shape, "", clips);
    if (array && IsArrayOfObjects(*array)) {
      const auto mapped = MappedFile::Open(path);
      const auto results = mapped ? MdmResults::Open((*mapped)->bytes(), name) : Expected<MdmResults>();
      for (std::size_t i = 0; mapped && results && i < results->size(); ++i) {
        clips.push_back({"[" + std::to_string(i) + "]", results->joints(), results->Label(i)});
      }
    }
  } else if (KindOf(head) == FileKind::kZip) {
    const auto mapped = MappedFile::Open(path);
    if (!mapped) return clips;
    const Expected<Npz> archive = ParseNpz((*mapped)->bytes(), name);
    if (!archive) return clips;
    if (const auto exported = ExportedMotionIn(*archive)) return {{"", exported->names.size(), ""}};
    for (const NpzMember& member : archive->members) {
      if (member.skipped.empty() && !member.array.values.empty() && !IsBodyParameter(member.name))
        AddClips(member.array.shape, "[" + member.name + "]", clips);
    }
  }
  return clips;
}

std::string RecordingSuffix(const std::string& id) {
  std::string suffix;
  for (const std::string& part : PartsOf(id)) {
    const int missing = IsNumber(part) ? kDigits - static_cast<int>(part.size()) : 0;
    suffix += "." + std::string(static_cast<std::size_t>(std::max(0, missing)), '0') + IdPart(part);
  }
  return suffix;
}

Expected<ArrayOfClip> ReadArrayClip(std::string_view bytes, const std::string& id, const std::string& name) {
  std::vector<std::string> parts = PartsOf(id);
  const auto alone = [](Expected<NpyArray> array) -> Expected<ArrayOfClip> {
    if (!array) return Forward(array);
    return ArrayOfClip{*std::move(array), {}, {}};
  };
  if (KindOf(bytes) != FileKind::kZip) {
    if (parts.empty()) return alone(ParseNpy(bytes, name));
    const auto entry = static_cast<std::size_t>(ParseInteger(parts[0]).value_or(0));
    const Expected<NpyArray> header = ParseNpyHeader(bytes, name);
    if (!header) return Forward(header);
    if (IsArrayOfObjects(*header)) {
      const Expected<MdmResults> results = MdmResults::Open(bytes, name);
      if (!results) return Forward(results);
      return alone(results->Motion(entry));
    }
    const std::optional<ArrayShape> shape = ShapeOfJoints(header->shape);
    if (!shape || !shape->frames_last) return alone(ParseNpyEntry(bytes, entry, name));
    Expected<NpyArray> clip = ParseNpyEntry(bytes, shape->classes > 0 ? entry / shape->classes : entry, name);
    if (clip && shape->classes > 0) clip = EntryOf(*std::move(clip), entry % shape->classes, name);
    if (!clip) return Forward(clip);
    return alone(FramesFirst(*clip, shape->frames));
  }
  Expected<Npz> npz = ParseNpz(bytes, name);
  if (!npz) return Forward(npz);
  if (const auto exported = ExportedMotionIn(*npz); exported && parts.empty())
    return ArrayOfClip{*exported->joints, exported->names, exported->rate_hz,
                       exported->state == nullptr ? std::vector<double>() : exported->state->values};
  if (!npz->unsafe.empty() && (parts.empty() || npz->Find(parts[0]) == nullptr))
    return tl::unexpected<Error>(npz->unsafe.front());
  if (parts.empty()) {
    return Fail(ErrorCode::kInconsistent, "the archive has no array of joint positions", name,
                "expected: (frames, joints, 3), (frames, joints * 3), or a batch of them");
  }
  const NpyArray* array = npz->Find(parts[0]);
  if (array == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the archive has no array '" + parts[0] + "'", name);
  }
  if (parts.size() == 1) return alone(*array);
  const auto entry = static_cast<std::size_t>(ParseInteger(parts[1]).value_or(0));
  const std::optional<ArrayShape> shape = ShapeOfJoints(array->shape);
  const std::size_t classes = shape ? shape->classes : 0;
  Expected<NpyArray> clip = EntryOf(*array, classes > 0 ? entry / classes : entry, name);
  if (clip && classes > 0) clip = EntryOf(*std::move(clip), entry % classes, name);
  if (!clip || !shape || !shape->frames_last) return alone(std::move(clip));
  return alone(FramesFirst(*clip, shape->frames));
}

std::optional<AxisOrder> ExchangedAxes(const NpyArray& array, std::size_t joints) {
  if (array.shape.size() != 3 || array.values.empty()) return std::nullopt;
  if (std::none_of(std::begin(kExchanged), std::end(kExchanged),
                   [&](const Axes& axes) { return Possible(array, axes); }))
    return std::nullopt;
  if (array.shape[0] == 3 && array.shape[2] % 3 == 0 && array.shape[2] / 3 >= kFewestArrayJoints) {
    // A batch of three clips, (clips, frames, joints * 3).
    const NpyArray first = EntryOf(array, 0, "").value_or(NpyArray());
    const std::vector<std::size_t> shape = {array.shape[1], array.shape[2] / 3, 3};
    if (BodyIn(ReadPoints({shape, first.dtype, first.values, {}}, kAsItLies))) return std::nullopt;
  }
  bool loose = true;  // no two points keep their distance as they lie
  if (array.shape[2] == 3) {
    if (joints > 0 && array.shape[1] == joints) return std::nullopt;
    const Points points = ReadPoints(array, kAsItLies);
    if (BodyIn(points)) return std::nullopt;
    loose = Rigidity(points.positions, points.confidence) > kRigid;
  }
  // A body says more than distances that are kept: frames that follow each other keep some too.
  std::optional<AxisOrder> likeliest;
  double least = kClearlyRigid;
  for (const Axes& axes : kExchanged) {
    if (!Possible(array, axes) || (joints > 0 && array.shape[axes[1]] != joints)) continue;
    const Points points = ReadPoints(array, axes);
    const std::optional<std::string> body = BodyIn(points);
    const double rigidity = body || !loose ? kClearlyRigid : Rigidity(points.positions, points.confidence);
    const bool rigid = rigidity < least;
    const bool declared = joints > 0 && !likeliest;
    if (!body && !rigid && !declared) continue;
    AxisOrder order;
    order.words = "its axes are " + ShapeOfAxes(axes) + ", not (frames, joints, 3): so " +
                  (body    ? "the points are a body in the order '" + *body + "', as they lie they are none"
                   : rigid ? "the points keep their distances, as they lie they do not"
                           : "it has the " + std::to_string(joints) + " joints that are declared");
    order.way_out = "write it with numpy's transpose(" + std::to_string(axes[0]) + ", " + std::to_string(axes[1]) +
                    ", " + std::to_string(axes[2]) + ")";
    if (body) return order;
    if (rigid) least = rigidity;
    likeliest = std::move(order);
  }
  return likeliest;
}

DamagedNumbers DamagedNumbersOf(const double* xyz, int frames, int joints, const std::string& name) {
  struct Tally {
    long long numbers = 0;
    int frames = 0, first = 0, last = 0;
    std::string place;
  };
  Tally not_finite, too_large;
  DamagedNumbers damaged;
  const std::ptrdiff_t wide = static_cast<std::ptrdiff_t>(joints) * 3;
  for (int f = 0; f < frames; ++f) {
    const double* row = xyz + f * wide;
    for (std::ptrdiff_t at = 0; at < wide; ++at) {
      const double value = row[at];
      if (std::isfinite(value) && std::abs(value) <= kLargestNumber) continue;
      Tally& tally = std::isfinite(value) ? too_large : not_finite;
      if (tally.numbers++ == 0) {
        tally.first = f;
        tally.place = "frame " + std::to_string(f) + ", joint " + std::to_string(at / 3) + ", " + "xyz"[at % 3] + ": " +
                      (std::isnan(value) ? "NaN" : FormatDouble(value));
      }
      if (tally.frames == 0 || tally.last != f) ++tally.frames;
      tally.last = f;
      if (damaged.frames.empty() || damaged.frames.back() != f) damaged.frames.push_back(f);
    }
  }
  const auto tell = [&](const char* code, const Tally& tally, const char* one, const char* many) {
    if (tally.numbers == 0) return;
    Finding finding =
        FrameFinding(code, tally.first, tally.last + 1, "", static_cast<double>(tally.numbers),
                     name + ": " + Counted(tally.numbers, "number") + " in " + std::to_string(tally.frames) + " of " +
                         Counted(frames, "frame") + (tally.numbers == 1 ? one : many) +
                         (tally.numbers == 1 ? ", in " : ", the first in ") + tally.place);
    finding.action = FindingAction::kDropped;
    damaged.findings.push_back(std::move(finding));
  };
  tell("not_a_number", not_finite, " is not finite", " are not finite");
  tell("number_too_large", too_large, " is no coordinate of a person", " are no coordinates of a person");
  return damaged;
}

tl::unexpected<Error> NoValidSamples(std::size_t numbers, const std::string& name) {
  return Fail(ErrorCode::kMalformed,
              "all " + std::to_string(numbers) + " numbers are NaN or infinite, or beyond any person: no joint is seen",
              name, "leave the file out", Reason::kNoValidSamples);
}

}  // namespace mocurate
