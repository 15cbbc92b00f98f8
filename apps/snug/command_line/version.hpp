// version: what this program is, for people and for recordings.
#pragma once

namespace snug::app {

/// "0.1.0", and behind it the commit in brackets when it was built in a git checkout, with -dirty when that was
/// changed.
[[nodiscard]] const char* version_text();

}  // namespace snug::app
