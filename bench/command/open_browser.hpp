// Has this machine's user shown an address.
#pragma once

#include <string>

namespace pelt {

// False: there is no desktop or no program for it here, or it could not be started.
bool OpenBrowser(const std::string& address);

}  // namespace pelt
