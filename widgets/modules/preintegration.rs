widgets::module!(widgets::preintegration::Preintegration);
