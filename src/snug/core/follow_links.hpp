// follow_links: the place that a name stands for.
#pragma once

#include <filesystem>

namespace snug {

/// Where the symbolic link `path` leads to, which need not exist; `path` itself when it is none. Throws InputError for
/// a circle of links.
[[nodiscard]] std::filesystem::path follow_links(const std::filesystem::path& path);

}  // namespace snug
