#include "tandem/verification/verify.h"
