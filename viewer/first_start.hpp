#pragma once

namespace palpate {

/// Whether `palpate view` never asked this before on this account; asking is remembered, in
/// $XDG_STATE_HOME/palpate or ~/.local/state/palpate. false where it cannot be remembered, since
/// every start would be the first then.
bool firstStart();

}  // namespace palpate
