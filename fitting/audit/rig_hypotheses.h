#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"

namespace mocurate {

/// The keypoint files of a rig, read otherwise than they are given.
struct RigHypothesis {
  std::vector<std::size_t> source;  ///< (views) camera v's detections lie in the files of camera source[v]
  std::vector<std::size_t> views;   ///< whose detections mean something else; empty where files are exchanged
  bool mirrored = false;            ///< there x is counted from the right
  bool sides = false;               ///< and left is called right, as a detector does in a mirrored image
  double factor = 1.0;              ///< pixels are so many times too small

  bool ExchangesFiles() const { return views.empty(); }
  std::size_t Displaced() const;  ///< files that lie elsewhere
};

/// What views agree on that they do not agree on as given.
struct RigHypotheses {
  /// The best hypothesis, and others that explain the take as well with as few changes: then it is ambiguous.
  std::vector<RigHypothesis> alike;
  double agreement = 0.0;   ///< share of the entries that belong to a body, as given
  double read = 0.0;        ///< and read so
  double given_cost = 0.0;  ///< of an entry as given (CostOfAgreement), mean
  double read_cost = 0.0;   ///< and read so: this decides
  double confidence = 0.0;  ///< that the first is better than as given, and than any other reading but those of `alike`
};

/// Readings after which views agree on people that they do not agree on as given: files exchanged between cameras (all
/// permutations of up to five views, pairs of up to twelve); one view, or all, mirrored or of images of another size (a
/// quarter to four times); one view that calls left right. Judged at 24 moments by which entries belong to a body that
/// others propose (ProposePeople), and how far they are from its rays. Of a rig that looks the same from several sides
/// more than one reading explains as much: the one that moves the fewest files, and all others that move as few (a ring
/// of four before which two cameras that face each other were exchanged sees a mirrored person, as it does when the
/// other two were, and when all images are mirrored). Which side is which in a mirrored image is not asked here. None
/// for fewer than three and more than twelve views, where files agree as they are, and where nothing agrees much
/// better.
RigHypotheses FindRigHypotheses(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                const std::vector<KnownLength>& lengths, double min_confidence, double sure);

/// Of views of which anatomy says that all call left right, the readings that turn the person over instead and on which
/// they agree no worse than as given: two files exchanged, or all images mirrored. None: it is the names.
std::vector<RigHypothesis> FindMirroredHypotheses(const std::vector<KeypointView>& views,
                                                  const std::vector<std::string>& names,
                                                  const std::vector<KnownLength>& lengths, double min_confidence,
                                                  double sure);

/// Names of the cameras that are read otherwise: "cam01, cam03".
std::string CamerasOf(const RigHypothesis& reading, const std::vector<KeypointView>& views);

/// What a reading says, of cameras by name.
std::string WordsOf(const RigHypothesis& reading, const std::vector<KeypointView>& views);

/// The views as a reading has them; cameras stay.
std::vector<KeypointView> WithHypothesis(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                         const RigHypothesis& reading);

}  // namespace mocurate
