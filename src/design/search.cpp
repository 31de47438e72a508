#include "zwidth/design/search.h"
