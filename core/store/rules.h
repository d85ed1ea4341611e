#pragma once

#include <string>
#include <vector>

#include "core/store/table.h"

/// The rules of the table. Each gives its words and its check.
namespace mocurate::store {

Rule Anything();
Rule NotEmpty();
Rule EqualTo(const std::string& text);
Rule OneOf(const std::vector<std::string>& texts);
Rule Finite();
/// Finite and in [low, high]; for integers as well.
Rule InRange(double low, double high);
Rule AtLeast(double low);
Rule AtMost(double high);
Rule NotZero();
/// The first four of each row of `stride` numbers are a unit quaternion (w, x, y, z); all are finite.
Rule UnitQuaternion(double tolerance);
/// A symmetric 3x3 matrix as xx xy xz yy yz zz whose diagonal is not negative.
Rule Covariance();
Rule Sha256Digits(bool may_be_empty);
Rule RateText();
Rule AxesText();
Rule JsonTexts();
/// Each is the position of a row of `field` (a path below the prefix); -1 is allowed if `or_none`.
Rule RowOf(const std::string& field, bool or_none = false);
Rule UniqueNames();
Rule NotBelow(const std::string& sibling);
Rule Rising();

Rule Parents();
Rule MirrorPartners();
Rule ChainLengths();

Rule SortedIds();
Rule OffsetsTileFrames();
Rule RateOfClips();
Rule ClassOfLabel();
Rule OptionalFieldMask();
Rule SplitRows();
Rule ForwardKinematicsJoints();

/// Counts of views that sum to the rows of `field`.
Rule ViewCounts(const std::string& field);
Rule RisingPerView();
/// A row of values per person of every image, by the counts and people of the same group: u px, v px, confidence.
Rule KeypointValues();

}  // namespace mocurate::store
