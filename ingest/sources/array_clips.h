#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/npy.h"
#include "core/formats/npz.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// The joints of a motion written by `mocurate export` (docs/exports.md): metres, right-handed, y up, facing +z.
struct ExportedMotion {
  const NpyArray* joints = nullptr;  ///< (F,J,3), of the archive
  std::vector<std::string> names;    ///< (J)
  std::vector<int> parents;          ///< (J), -1 for the root
  std::string skeleton;
  double rate_hz = 0.0;
  const NpyArray* state = nullptr;  ///< (F,J) JointState, of the archive; null where it has none
};

/// Nothing where `mocurate export` did not write the archive. `npz` has to outlive it.
std::optional<ExportedMotion> ExportedMotionIn(const Npz& npz);

/// Layout of an array of joint positions.
struct ArrayShape {
  bool batch = false;        ///< several clips of one length
  bool frames_last = false;  ///< coordinates before frames
  std::size_t clips = 1;
  std::size_t classes = 0;  ///< batch of batches: length of the second axis, the class; else 0
  std::size_t frames = 0;
  std::size_t joints = 0;
};

/// (frames, joints, 3), (frames, joints * 3), or a batch of them, of at least three joints. Also batches with the
/// frames last: (clips, joints, 3, frames), the memory layout of MDM and ACTOR, and (samples, classes, joints, 3,
/// frames), ACTOR's generation.npy. Nothing for others.
std::optional<ArrayShape> ShapeOfJoints(const std::vector<std::size_t>& shape);

/// Whether the array holds a pickle, as MDM's results.npy does.
bool IsArrayOfObjects(const NpyArray& header);

/// (frames, people, joints, 3), as NTU's are written: no batch of clips of one or two frames.
bool ArePeople(const std::vector<std::size_t>& shape);

/// What an array of this shape contains instead of positions, and how to get those (HumanML3D's features); else "".
std::string OtherThanJoints(const std::vector<std::size_t>& shape);

/// Whether SMPL's programs write rotation vectors, places or shapes under this name: "body_pose", "transl".
bool IsBodyParameter(std::string_view name);

/// What an array (frames, columns) is where it holds SMPL's rotation vectors, not joint positions: by the file's name,
/// or by as many numbers a frame as SMPL, SMPL-H or SMPL-X have, vectors of at most half a turn that are no body; else
/// "".
/// `declared`: bones of a source's order, in which the points may be a body.
std::string RotationsInstead(const NpyArray& array, const std::string& name, const std::vector<RawBone>& declared = {});

/// One clip of a file of arrays.
struct ArrayClip {
  std::string id;  ///< "[3]" of a batch, "[member]" of an .npz, "[member][3]"; empty: the file is the clip,
                   ///< an .npz of `mocurate export` too
  std::size_t joints = 0;
  std::string label;  ///< where the file states one: a name, or the index of a class
};

/// The clips of an .npy (only its header is read) or .npz, also of MDM's results.npy. Empty where the file has no
/// joints, is shorter than its header declares, or cannot be read; its reader reports why.
std::vector<ArrayClip> ArrayClipsOf(const std::filesystem::path& file, const std::string& name);

/// Suffix of the clip's name: "[walk][3]" gives ".walk.0003", "[a/b]" gives ".a.b".
std::string RecordingSuffix(const std::string& id);

/// The data of one clip of a file.
struct ArrayOfClip {
  NpyArray array;
  std::vector<std::string> names;  ///< of the joints, where the file is one of `mocurate export`
  std::optional<double> rate_hz;   ///< likewise
  std::vector<double> state = {};  ///< (F*J) JointState, likewise; or none
};

/// Errors of the formats; kInconsistent where the clip does not exist.
Expected<ArrayOfClip> ReadArrayClip(std::string_view bytes, const std::string& id, const std::string& name);

struct AxisOrder {
  std::string words;    ///< "its axes are (joints, frames, 3), ..."
  std::string way_out;  ///< "write it with numpy's transpose(1, 0, 2)"
};

/// An array (a, b, 3), (a, 3, b) or (3, a, b) whose axes are in another order than (frames, joints, 3): in that order
/// the points are a body (a known order of joints, or pairs that keep their distance), as they lie they are none.
/// `joints`: how many a source declares, which is enough where they lie along another axis; 0: not known.
std::optional<AxisOrder> ExchangedAxes(const NpyArray& array, std::size_t joints);

/// Numbers of (frames, joints, 3) that are none, or beyond any person: frames that hold some, rising, and a finding for
/// all that are not finite ("not_a_number") and for all that are too large ("number_too_large"), with their count as
/// value and the place of the first; action "dropped".
struct DamagedNumbers {
  std::vector<int> frames;
  std::vector<Finding> findings;
};
DamagedNumbers DamagedNumbersOf(const double* xyz, int frames, int joints, const std::string& name);

/// The error of an array whose numbers are all damaged.
tl::unexpected<Error> NoValidSamples(std::size_t numbers, const std::string& name);

}  // namespace mocurate
