widgets::module!(widgets::bundle_adjustment::BundleAdjustment);
