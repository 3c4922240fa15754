// Not Pelt's: the outside project has a file of this name too.
#pragma once

namespace outside {
inline constexpr int kErrorCode = 7;
}
