#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"

namespace mocurate {

/// A hypothesis about wrong keypoint files of a rig.
struct RigHypothesis {
  std::vector<std::size_t> source;  ///< (views) camera v's detections are in the files of camera source[v]
  std::vector<std::size_t> views;   ///< views that are changed; empty where files are exchanged
  bool mirrored = false;            ///< their x counts from the right of the calibrated image, after `factor`
  bool sides = false;               ///< their left and right are exchanged, as by a detector on a mirrored image
  double factor = 1.0;              ///< factor on their pixels

  static RigHypothesis AsGiven(std::size_t views);
  bool ExchangesFiles() const { return views.empty(); }
  bool ChangesView(std::size_t v) const;
  bool Concerns(std::size_t v) const { return source[v] != v || ChangesView(v); }
  std::size_t Displaced() const;  ///< number of exchanged files
};

/// Hypotheses under which views agree that do not agree as given.
struct RigHypotheses {
  /// The best one first, then all that explain the views equally well with as few changes: these are ambiguous.
  std::vector<RigHypothesis> alike;
  double agreement = 0.0;        ///< share of the entries that match a body, as given
  double read = 0.0;             ///< and under the hypothesis
  double given_cost = 0.0;       ///< mean cost of an entry as given (CostOfAgreement)
  double read_cost = 0.0;        ///< and under the hypothesis: this decides
  double confidence = 0.0;       ///< that it is better than as given, and than all hypotheses outside `alike`, where
                                 ///< half of the moments chooses and the other half judges (HeldOutCosts)
  std::vector<double> moment_s;  ///< when they were compared
  /// (moments) as given, and under the hypothesis that the other half of the moments chooses
  std::vector<double> given_costs, read_costs;
};

/// Finds hypotheses under which views agree on people that they do not agree on as given:
/// - files exchanged between cameras (all permutations of up to five views, pairs of up to twelve);
/// - one view, or all, mirrored or of images of another size (a quarter to four times);
/// - left and right exchanged in one view.
/// Each is scored at 24 moments by the entries that match a body of the other views (ProposePeople) and their distance
/// from its rays. For a symmetric rig, several hypotheses explain as much: returns the one with the fewest exchanged
/// files and all others with as few. In a ring of four with two opposite cameras exchanged, the person appears
/// mirrored. The other two exchanged, or all images mirrored, give the same result. Left and right in a mirrored image
/// are decided later. Empty for fewer than three or more than twelve views, for views that agree as given, and without
/// a clear improvement.
RigHypotheses FindRigHypotheses(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                const std::vector<KnownLength>& lengths, double min_confidence, double sure);

/// For views of which anatomy shows all sides exchanged: hypotheses that mirror the person instead, and under which
/// views agree no worse than as given. These are two exchanged files, or all images mirrored. Empty: the names are
/// wrong.
std::vector<RigHypothesis> FindMirroredHypotheses(const std::vector<KeypointView>& views,
                                                  const std::vector<std::string>& names,
                                                  const std::vector<KnownLength>& lengths, double min_confidence,
                                                  double sure);

/// Names of the changed cameras: "cam01, cam03".
std::string CamerasOf(const RigHypothesis& hypothesis, const std::vector<KeypointView>& views);

/// The text of a hypothesis, with names of cameras.
std::string WordsOf(const RigHypothesis& hypothesis, const std::vector<KeypointView>& views);

/// The views under a hypothesis; cameras stay.
std::vector<KeypointView> WithHypothesis(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                         const RigHypothesis& hypothesis);

}  // namespace mocurate
