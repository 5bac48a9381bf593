#include "tandem/collision/ssv_checker.h"
